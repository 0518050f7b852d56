"""MAVLink 2 signing: who has no key is not heard."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from wigwag.errors import InputError

_EPOCH_S = 1_420_070_400
"""1 January 2015, from which signatures count time (mavlink.io, 'Message Signing')."""
_RADIO_STATUS = 109
"""Radios put it into the stream themselves and have no key."""


def read_key(path: Path) -> bytes:
    """Read a signing key: 32 bytes as they are, 64 hexadecimal digits, or a passphrase.

    A passphrase becomes a key by SHA-256 of its first line, as in Mission Planner and MAVProxy.

    Raises:
        InputError: If the file cannot be read or is empty.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: the signing key cannot be read ({error.strerror}).") from error
    if len(data) == 32:
        return data
    line = data.split(b"\n", 1)[0].strip()
    if not line:
        raise InputError(
            f"{path}: holds no signing key. Expected 32 bytes, 64 hexadecimal digits or a passphrase."
        )
    try:
        key = bytes.fromhex(line.decode("ascii"))
    except (UnicodeDecodeError, ValueError):
        key = b""
    return key if len(key) == 32 else hashlib.sha256(line).digest()


def sign(coder: Any, key: bytes, wall_clock_s: float) -> None:
    """Let a pymavlink ``MAVLink`` sign what it sends, and refuse what is not signed with the same key.

    Args:
        coder: pymavlink's encoder and decoder.
        key: 32 bytes.
        wall_clock_s: Seconds since 1970; signatures must not run back in time from one start to the next.
    """
    signing = coder.signing
    signing.secret_key = key
    signing.timestamp = max(0, int((wall_clock_s - _EPOCH_S) * 1e5))
    signing.sign_outgoing = True
    signing.allow_unsigned_callback = lambda _, message_id: message_id == _RADIO_STATUS
