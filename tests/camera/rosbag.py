"""Small bags, written by ``rosbags``: ROS 1, ROS 2 (SQLite) and MCAP."""

from contextlib import contextmanager
from pathlib import Path

import numpy as np

COLOR, DEPTH = "/camera/color/image_raw", "/camera/depth/image_rect_raw"
INFO, DEPTH_INFO = "/camera/color/camera_info", "/camera/depth/camera_info"


class Writer:
    """Writes messages of one distribution. ``ros1`` has other fields in places."""

    def __init__(self, bag, store, ros1):
        self.bag, self.store, self.ros1, self.connections = bag, store, ros1, {}
        self.types = store.types

    def write(self, topic, message, log_ns):
        kind = message.__msgtype__
        if topic not in self.connections:
            self.connections[topic] = self.bag.add_connection(topic, kind, typestore=self.store)
        pack = self.store.serialize_ros1 if self.ros1 else self.store.serialize_cdr
        self.bag.write(self.connections[topic], log_ns, pack(message, kind))

    def header(self, stamp_ns, frame_id):
        stamp = self.types["builtin_interfaces/msg/Time"](stamp_ns // 10**9, stamp_ns % 10**9)
        more = {"seq": 0} if self.ros1 else {}
        return self.types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame_id, **more)

    def image(self, stamp_ns, pixels, encoding, frame_id="color"):
        pixels = np.ascontiguousarray(pixels)
        rows = pixels.reshape(pixels.shape[0], -1).view(np.uint8)
        return self.types["sensor_msgs/msg/Image"](
            header=self.header(stamp_ns, frame_id),
            height=pixels.shape[0],
            width=pixels.shape[1],
            encoding=encoding,
            is_bigendian=0,
            step=rows.shape[1],
            data=rows.ravel(),
        )

    def compressed(self, stamp_ns, data, kind, frame_id="color"):
        return self.types["sensor_msgs/msg/CompressedImage"](
            header=self.header(stamp_ns, frame_id), format=kind, data=np.frombuffer(data, np.uint8)
        )

    def info(self, stamp_ns, i, frame_id="color"):
        k = np.array([i.fx, 0, i.cx, 0, i.fy, i.cy, 0, 0, 1.0])
        names = ("D", "K", "R", "P") if self.ros1 else ("d", "k", "r", "p")
        matrices = (np.zeros(5), k, np.eye(3).ravel(), np.zeros(12))
        roi = self.types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
        return self.types["sensor_msgs/msg/CameraInfo"](
            header=self.header(stamp_ns, frame_id),
            height=i.height,
            width=i.width,
            distortion_model="plumb_bob",
            binning_x=0,
            binning_y=0,
            roi=roi,
            **dict(zip(names, matrices, strict=True)),
        )

    def tf(self, parent, child, translation, quaternion=(0.0, 0.0, 0.0, 1.0)):
        t = self.types
        transform = t["geometry_msgs/msg/Transform"](
            t["geometry_msgs/msg/Vector3"](*translation), t["geometry_msgs/msg/Quaternion"](*quaternion)
        )
        stamped = t["geometry_msgs/msg/TransformStamped"](self.header(0, parent), child, transform)
        return t["tf2_msgs/msg/TFMessage"]([stamped])


@contextmanager
def bag(folder, kind):
    """Open a new bag of a kind ("ros1", "ros2", "mcap"); its path is ``writer.path``."""
    from rosbags import rosbag1, rosbag2
    from rosbags.typesys import Stores, get_typestore

    if kind == "ros1":
        path = Path(folder) / "flight.bag"
        store, made = get_typestore(Stores.ROS1_NOETIC), rosbag1.Writer(path)
    else:
        path = Path(folder) / f"flight_{kind}"
        plugin = rosbag2.StoragePlugin.MCAP if kind == "mcap" else rosbag2.StoragePlugin.SQLITE3
        store = get_typestore(Stores.ROS2_HUMBLE)
        made = rosbag2.Writer(path, version=9, storage_plugin=plugin)
    with made as opened:
        writer = Writer(opened, store, ros1=kind == "ros1")
        writer.path = path
        yield writer
