"""Kernels written in a small subset of Python, translated whole to LLVM IR and compiled by llvmlite."""
