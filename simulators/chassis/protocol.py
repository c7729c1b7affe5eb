# SPDX-License-Identifier: MIT
"""NI's protocol, from the official client package.

The package's generated modules are private to it, but they are the published interface
of NI's device server; a simulated server that used a copy would test the copy.
"""

from typing import Any

import grpc
from nidaqmx import constants
from nidaqmx._stubs import nidaqmx_pb2, nidaqmx_pb2_grpc  # noqa: PLC2701
from nidaqmx.error_codes import DAQmxErrors

__all__ = [
    "DAQmxErrors",
    "Daqmx",
    "Refusal",
    "Servicer",
    "add_servicer",
    "bad_value",
    "constants",
    "number_of",
    "refuse",
]

Daqmx: Any = nidaqmx_pb2
Servicer: Any = nidaqmx_pb2_grpc.NiDAQmxServicer
add_servicer: Any = nidaqmx_pb2_grpc.add_NiDAQmxServicer_to_server


class Refusal(Exception):
    """A DAQmx error: its negative code, its text, and the samples read.

    Attributes:
        code: of DAQmx.
        read: samples per channel that a read delivered, None for other calls.
    """

    def __init__(self, code: int, words: str, *, read: int | None = None) -> None:
        super().__init__(words)
        self.code = int(code)
        self.read = read


def refuse(context: grpc.ServicerContext, refusal: Refusal, task: str = "") -> None:
    """End a call as NI's server does, with the code in the trailing metadata."""
    metadata = [("ni-error", str(refusal.code))]
    if refusal.read is not None:
        metadata.append(("ni-samps-per-chan-read", str(refusal.read)))
    context.set_trailing_metadata(tuple(metadata))
    name = f"\n\nTask Name: {task}" if task else ""
    text = f"{refusal}{name}\n\nStatus Code: {refusal.code}"
    context.abort(grpc.StatusCode.UNKNOWN, text)


def bad_value(
    name: str,
    asked: object,
    *,
    low: float | None = None,
    high: float | None = None,
    choice: tuple[object, ...] = (),
    channel: str = "",
) -> Refusal:
    """Return the refusal of a property's value, in the words of NI-DAQmx.

    Args:
        name: of the property, without ``DAQmx_``.
        asked: value.
        low: least value supported.
        high: largest value supported.
        choice: values supported.
        channel: concerned.
    """
    lines = [
        "Requested value is not a supported value for this property. The property "
        "value may be invalid because it conflicts with another property.\n",
        f"Property: DAQmx_{name}",
        f"Requested Value: {asked}",
    ]
    lines += [] if high is None else [f"Maximum Value:  {high:f}"]
    lines += [] if low is None else [f"Minimum Value: {low:f}"]
    lines += [f"You Can Select: {', '.join(map(str, choice))}"] if choice else []
    lines += [f"Channel Name: {channel}"] if channel else []
    return Refusal(DAQmxErrors.INVALID_ATTRIBUTE_VALUE, "\n".join(lines))


def number_of(request: Any, field: str) -> int:
    """Return an enumerated field, which travels as a name or as a raw number."""
    return int(getattr(request, f"{field}_raw") or getattr(request, field))
