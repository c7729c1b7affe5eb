# SPDX-License-Identifier: MIT
"""NI's protocol, from the official client package.

The package's generated modules are private to it, but they are the published interface
of NI's device server; a simulated server that used a copy would test the copy.
"""

from typing import Any

import grpc
from nidaqmx._stubs import nidaqmx_pb2, nidaqmx_pb2_grpc  # noqa: PLC2701
from nidaqmx.constants import (
    AccelSensitivityUnits,
    AccelUnits,
    AcquisitionType,
    ExcitationSource,
    ForceIEPESensorSensitivityUnits,
    ForceUnits,
    OverwriteMode,
    ReadRelativeTo,
)
from nidaqmx.error_codes import DAQmxErrors

__all__ = [
    "AccelSensitivityUnits",
    "AccelUnits",
    "AcquisitionType",
    "DAQmxErrors",
    "Daqmx",
    "ExcitationSource",
    "ForceIEPESensorSensitivityUnits",
    "ForceUnits",
    "OverwriteMode",
    "ReadRelativeTo",
    "Refusal",
    "Servicer",
    "add_servicer",
    "attribute_of",
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
        self.code = code
        self.read = read


def refuse(context: grpc.ServicerContext, refusal: Refusal) -> None:
    """End a call as NI's server does, with the code in the trailing metadata."""
    metadata = [("ni-error", str(refusal.code))]
    if refusal.read is not None:
        metadata.append(("ni-samps-per-chan-read", str(refusal.read)))
    context.set_trailing_metadata(tuple(metadata))
    context.abort(grpc.StatusCode.UNKNOWN, f"{refusal}\n\nStatus Code: {refusal.code}")


def attribute_of(request: Any) -> int:
    """Return the attribute of a request, from either of two fields."""
    return int(request.attribute_raw or request.attribute)
