"""Stand-ins with the fields of ROS messages."""

from types import SimpleNamespace as Message


def vector(x=0.0, y=0.0, z=0.0):
    return Message(x=x, y=y, z=z)


def odometry(position=(0, 0, 0), velocity=(0, 0, 0), quaternion=(0, 0, 0, 1), child="base_link"):
    x, y, z, w = quaternion
    return Message(
        header=Message(frame_id="odom"),
        child_frame_id=child,
        pose=Message(pose=Message(position=vector(*position), orientation=Message(x=x, y=y, z=z, w=w))),
        twist=Message(twist=Message(linear=vector(*velocity), angular=vector())),
    )
