"""librealsense's software device: a RealSense without hardware."""

import numpy as np

from wigwag.camera.align import Extrinsic
from wigwag.camera.frame import Intrinsics

DEPTH = Intrinsics(fx=96.0, fy=97.0, cx=63.2, cy=47.4, width=128, height=96)
COLOR = Intrinsics(fx=154.0, fy=153.0, cx=80.6, cy=59.1, width=160, height=120)
SIDEWAYS = Extrinsic(np.eye(3), np.array([0.015, 0.0005, 0.0]))


class SoftwareRealSense:
    """Colour and depth streams that are fed by hand; a source of framesets for ``RealSenseSource``.

    Args:
        rs: ``pyrealsense2``.
        record: File that all frames are written to.
        color: Which kind of colour: "rgb8", "bgr8", "yuyv" or "y8".
        unit_m: Metres a count of depth.
    """

    def __init__(self, rs, extrinsic=SIDEWAYS, record=None, color="rgb8", unit_m=0.001):
        self.rs, self.unit_m, self.color, self.unplugged = rs, unit_m, color, False
        self.device = rs.software_device()
        sensors = self.device.add_sensor("Stereo Module"), self.device.add_sensor("RGB Camera")
        kind = getattr(rs.format, color)
        self.bytes = {"rgb8": 3, "bgr8": 3, "yuyv": 2, "y8": 1}[color]
        self.depth = sensors[0].add_video_stream(self._stream(rs.stream.depth, 1, rs.format.z16, 2, DEPTH))
        self.colour = sensors[1].add_video_stream(self._stream(rs.stream.color, 2, kind, self.bytes, COLOR))
        sensors[0].add_read_only_option(rs.option.depth_units, unit_m)
        pose = rs.extrinsics()
        pose.rotation = extrinsic.rotation.T.ravel().tolist()  # librealsense: column after column
        pose.translation = extrinsic.translation_m.tolist()
        self.depth.register_extrinsics_to(self.colour, pose)
        self.device.create_matcher(rs.matchers.default)
        self.sensors, self.syncer = sensors, rs.syncer()
        self.recorder = rs.recorder(str(record), self.device) if record else None
        self.streaming = self.recorder.query_sensors() if record else sensors
        for sensor in self.streaming:
            sensor.open(sensor.get_stream_profiles())
        for sensor in self.streaming:
            sensor.start(self.syncer)
        self.count, self.kept, self.synced = 0, [], []

    def push(self, depth, color, stamp_ms=None):
        """Feed one pair of pictures."""
        stamp_ms = 33.0 * self.count if stamp_ms is None else stamp_ms
        self.kept = [*self.kept[-40:], depth, color]  # librealsense does not copy them
        for sensor, profile, pixels, size in (
            (self.sensors[0], self.depth, depth, 2),
            (self.sensors[1], self.colour, color, self.bytes),
        ):
            f = self.rs.software_video_frame()
            f.pixels, f.bpp, f.stride = pixels, size, size * pixels.shape[1]
            f.timestamp, f.domain = stamp_ms, self.rs.timestamp_domain.hardware_clock
            f.frame_number, f.profile = self.count, profile.as_video_stream_profile()
            if size == 2 and sensor is self.sensors[0]:
                f.depth_units = self.unit_m
            sensor.on_video_frame(f)
        self.count += 1

    def wait(self, timeout_ms):
        """Return the next set; a device that was unplugged raises as librealsense does."""
        if self.unplugged:
            raise RuntimeError("Device disconnected")
        return self.syncer.wait_for_frames(timeout_ms)

    def pair(self, depth, color):
        """Feed a pair and return its set, with both in it."""
        for _ in range(4):
            self.push(depth, color)
            frames = self.wait(1000)
            if frames.get_depth_frame() and frames.get_color_frame():
                return frames
        raise AssertionError("librealsense never joined depth and colour")

    def stop(self):
        """End the streams and finish the recording."""
        for sensor in self.streaming:
            sensor.stop()
            sensor.close()
        self.streaming, self.recorder = [], None

    def _stream(self, kind, uid, fmt, size, i):
        stream = self.rs.video_stream()
        stream.type, stream.index, stream.uid, stream.fmt = kind, 0, uid, fmt
        stream.width, stream.height, stream.fps, stream.bpp = i.width, i.height, 30, size
        stream.intrinsics = self._intrinsics(i)
        return stream

    def _intrinsics(self, i):
        out = self.rs.intrinsics()
        out.width, out.height, out.fx, out.fy, out.ppx, out.ppy = i.width, i.height, i.fx, i.fy, i.cx, i.cy
        out.model, out.coeffs = self.rs.distortion.none, [0.0] * 5
        return out
