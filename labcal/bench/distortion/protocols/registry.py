"""The protocols by name; a new one is a line here."""

from labcal.arguments import one_named
from labcal.bench.distortion.protocols.josa_volume import JOSA_VOLUME
from labcal.bench.distortion.protocols.protocol import Protocol
from labcal.bench.distortion.protocols.z_travel import REFINED_Z_TRAVEL, Z_TRAVEL

PROTOCOLS = {protocol.name: protocol for protocol in (JOSA_VOLUME, Z_TRAVEL, REFINED_Z_TRAVEL)}


def protocol_by_name(name: str) -> Protocol:
    """Return a protocol.

    Raises
    ------
    UnknownNameError
        There is none of that name; the nearest one is offered.
    """
    return one_named(PROTOCOLS, "protocol", name)
