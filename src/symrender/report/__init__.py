"""Report: a pair of renders judged by the truth, as one offline page."""
