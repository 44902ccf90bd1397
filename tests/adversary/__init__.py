"""An adversary of the package: values it makes itself, from scenes chosen to be nasty, and a judge between the two."""
