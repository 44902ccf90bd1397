"""The chapter: its laboratory of executed cells, and the document that shows them."""
