"""The chapter as one offline page: prose with holes for figures, and the measurements that fill them."""
