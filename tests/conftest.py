"""What holds for all tests: the same cases every time, however slow the machine; a thread a worker."""

import os

# Before numpy is first imported. The matrices here are small: two workers whose linear algebra takes two
# threads each on two cores wait for each other most of the time.
for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

from hypothesis import settings  # noqa: E402  # see above

settings.register_profile("fixed", derandomize=True, deadline=None, database=None)
settings.load_profile("fixed")
