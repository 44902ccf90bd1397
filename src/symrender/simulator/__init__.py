"""The live simulator: a scene compiled to one offline HTML file."""
