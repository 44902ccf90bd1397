# %% [markdown]
# # Cell 4
#
# The cell's introduction.

# %%
import symrender as sr

scene = sr.load("gloss")

# %%
assert scene.floor is not None, "the scene has a floor"
print("Expect: the scene has a floor.")
