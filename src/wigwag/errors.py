"""What wigwag raises when something is wrong: a message that names it, what was expected, what to do."""


class WigwagError(Exception):
    """Base of every error that wigwag raises on purpose; the command line prints it and exits with 2."""


class InputError(WigwagError, ValueError):
    """A value, file or array that was handed in is not what it must be."""


class DataError(InputError):
    """A recording on disk is missing, corrupt or irregular."""


class ModelError(WigwagError):
    """A model file is missing, damaged or of another version."""


class CameraError(WigwagError):
    """A camera cannot be opened, was lost, or gives no pictures."""


class VehicleError(WigwagError):
    """A vehicle cannot be reached, or is not one that can be flown."""


class MissingExtraError(WigwagError, ImportError):
    """An optional part is not installed; the message names the extra that brings it."""


class NotFittedError(WigwagError, AttributeError):
    """A recogniser or transform was used before ``fit``."""


class ViewError(WigwagError):
    """A window or page in which to look at things cannot be opened."""
