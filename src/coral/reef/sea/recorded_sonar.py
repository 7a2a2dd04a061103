"""A recording of a Sonar 3D-15 (.sonar) that plays as fast as it was made."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from coral.errors import InputError
from coral.foreign_file import open_regular
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.sea.sonar_packets import decode_packet, load_protocol, read_packets
from coral.reef.sea.sonar_reading import HeardImage

LONGEST_S = 1.0
"""A longer pause in the recording is not waited for."""


class RecordedSonar:
    """Reads the packets of a file, each when it is due."""

    def __init__(
        self,
        path: Path,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Open a recording.

        Args:
            path: File of packets, as the sonar's own page records them.
            clock: Monotonic time (s).
            sleep: Waits so long (s).

        Raises:
            InputError: There is no such file, it begins with no packet, or wlsonar is not installed.
        """
        load_protocol()
        try:
            self._file = open_regular(path)
        except OSError as error:
            raise InputError("--sonar", "", str(path), f"a recording of the sonar ({error.strerror})") from None
        try:
            next(read_packets(self._file), None)
        except UnfitMeasurement as unfit:
            self._file.close()
            raise InputError(
                str(path), "", f"{unfit.reason} {unfit.detail}", "packets of a Sonar 3D-15 (.sonar)"
            ) from None
        self._file.seek(0)
        self._packets = read_packets(self._file)
        self._clock, self._sleep = clock, sleep
        self._before_s: float | None = None
        self._due_s = clock()
        self.name = f"{path.name}, recorded"

    def read(self) -> HeardImage | None:
        """Wait until the next image is due.

        Raises:
            OSError: The recording has ended.
            UnfitMeasurement: A packet is broken.
        """
        packet = next(self._packets, None)
        if packet is None:
            raise OSError("the recording has ended")
        ping = decode_packet(packet)
        if ping is None:
            return None
        step_s = 0.0 if self._before_s is None else min(max(ping.device_s - self._before_s, 0.0), LONGEST_S)
        self._before_s = ping.device_s
        self._due_s = max(self._due_s + step_s, self._clock() - LONGEST_S)
        self._sleep(max(0.0, self._due_s - self._clock()))
        return HeardImage(self._clock(), ping.image)

    def close(self) -> None:
        """Close the file."""
        self._file.close()
