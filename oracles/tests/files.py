"""Small files of robots, in which every number differs from the others."""

from __future__ import annotations

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.reading import turned

LINK = """<link name="{name}"><inertial><origin xyz="{com}" rpy="{rpy}"/><mass value="{mass}"/>
<inertia ixx=".02" iyy=".03" izz=".04" ixy=".001" ixz=".002" iyz=".003"/></inertial></link>"""
JOINT = """<joint name="{name}" type="{type}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}" rpy="{rpy}"/>
<axis xyz="{axis}"/><limit lower="-1" upper="2" velocity="3" effort="40"/>{more}</joint>"""
GIVEN = np.array([[0.02, 0.001, 0.002], [0.001, 0.03, 0.003], [0.002, 0.003, 0.04]])


def link(name: str, mass: float = 1.5, com: str = ".1 .2 .3", rpy: str = "0 0 0") -> str:
    """A link of a URDF with the inertia `GIVEN` in the inertial's axes."""
    return LINK.format(name=name, mass=mass, com=com, rpy=rpy)


def joint(name: str, kind: str, parent: str, child: str, axis: str = "0 1 0", more: str = "") -> str:
    """A joint of a URDF at (.1, .2, .3), turned by 1.1 about x and then by 0.3 about z."""
    return JOINT.format(name=name, type=kind, parent=parent, child=child, xyz=".1 .2 .3", rpy="1.1 0 .3", axis=axis, more=more)


def about(axis: int, angle: float) -> Array:
    """The rotation about a coordinate axis."""
    half = np.zeros(4)
    half[0], half[axis + 1] = np.cos(angle / 2), np.sin(angle / 2)
    return turned(*half)


TURN = about(2, 0.3) @ about(0, 1.1)
ARM = f"""<robot name="arm">
{link("stand")}{link("upper", rpy=".4 .5 .6")}{link("flange", mass=0.5)}{link("slider")}{link("wheel")}{link("finger")}
{joint("shoulder", "revolute", "stand", "upper", more='<dynamics damping=".7" friction=".2"/>')}
{joint("glue", "fixed", "upper", "flange")}
{joint("rail", "prismatic", "flange", "slider", axis="0.6 0 0.8")}
{joint("axle", "continuous", "slider", "wheel", axis="0 0 1")}
{joint("grip", "revolute", "slider", "finger", axis="1 0 0", more='<mimic joint="rail" multiplier="2"/>')}
</robot>"""
LIGHT = f'<robot name="light">{link("stand")}<link name="empty"/>{joint("hinge", "revolute", "stand", "empty")}</robot>'
FLAT = (
    '<robot name="flat"><link name="stand"/><link name="plate"><inertial><mass value="2"/>'
    '<inertia ixx=".01" iyy=".01" izz=".05" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    f"{joint('hinge', 'revolute', 'stand', 'plate')}</robot>"
)
WORLD = f'<robot name="world"><link name="world"/>{link("arm")}{joint("hinge", "continuous", "world", "arm")}</robot>'
PLANE = f'<robot name="plane"><link name="stand"/>{link("sled")}{joint("skate", "planar", "stand", "sled", axis="0 0 1")}</robot>'
STEEP = PLANE.replace('<axis xyz="0 0 1"/>', '<axis xyz="1 0 0"/>')
FLOATING = f'<robot name="float"><link name="stand"/>{link("bird")}{joint("wing", "floating", "stand", "bird")}</robot>'
SLED = PLANE.replace('<axis xyz="0 0 1"/>', '<axis xyz="0.6 0 0.8"/>').replace(
    "</robot>", f"{link('bird')}{joint('wing', 'floating', 'sled', 'bird')}</robot>"
)
MESH = WORLD.replace("</link>", '<collision><geometry><mesh filename="package://nowhere/m.stl"/></geometry></collision></link>', 1)

MJCF = """<mujoco model="toy"><compiler angle="radian"/><option gravity="0 1 -5"/>
<default><default class="geared"><joint armature=".25" damping=".7"/></default></default>
<worldbody><body name="post" pos="0 0 1"><inertial pos="0 0 0" mass="9" diaginertia="1 1 1"/>
 <body name="arm" pos=".1 .2 .3" quat=".6 0 0 .8">
  <joint name="pan" class="geared" axis="0 0 1" pos=".5 0 0" range="-1 2"/><joint name="tilt" axis="0 1 0" pos="0 .25 0" frictionloss=".2"/>
  <inertial pos=".1 .2 .3" mass="1.5" fullinertia=".02 .03 .04 .001 .002 .003"/>
  <body name="cup" pos="0 0 .4"><inertial pos="0 0 .1" mass=".5" diaginertia=".02 .03 .04"/>
   <body name="ball" pos="1 0 0"><joint name="socket" type="ball"/><inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/></body>
  </body>
  <body name="rod" pos="0 1 0"><joint name="push" type="slide" axis="1 0 0" ref=".5"/><geom type="sphere" size=".1" mass="2"/></body>
 </body></body>
 {more}
</worldbody>
<actuator><motor joint="pan"/></actuator>
<keyframe><key name="home" qpos=".1 .2 1 0 0 0 .5 {key}"/></keyframe></mujoco>"""
THREE = """<mujoco model="three"><compiler angle="radian"/><worldbody><body name="car">
 <joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0" pos="5 5 5"/>
 <joint name="z" axis="0 0 1" pos=".5 0 0"/>
 <inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/>
 <body name="mast" pos="0 0 1"><joint name="ref" axis="0 1 0" ref=".3" range="-1 1"/>
 <inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/></body></body></worldbody></mujoco>"""
REFUSED = """<mujoco model="refused"><worldbody>
 <body name="flat"><joint name="h" axis="0 1 0"/><inertial pos=".1 0 0" quat=".6 0 0 .8" mass="1" diaginertia=".01 .02 .05"/>
 <body name="empty" pos="0 0 1"><joint name="k" axis="0 1 0"/></body></body></worldbody></mujoco>"""
DRAGGED = """<mujoco model="dragged"><default><joint armature=".25"/></default><worldbody>
 <body name="base"><joint name="root" type="free"/><inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/>
 <body name="arm" pos="0 0 1"><joint name="k" axis="0 1 0"/><inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/></body></body>
</worldbody><actuator><motor joint="k"/></actuator></mujoco>"""
LOOSE = """<body name="loose" pos="1 2 3"><freejoint name="fly"/><inertial pos="0 0 .1" mass="3" diaginertia=".02 .03 .04"/></body>"""
# A hinge with damping and a skew axis, a slider that mimics it, and links without an inertial.
TOY = """<robot name="toy"><link name="stand"/>
<link name="arm"><inertial><origin xyz=".1 .2 .3" rpy=".4 .5 .6"/><mass value="1.5"/>
<inertia ixx=".02" iyy=".03" izz=".04" ixy=".001" ixz=".002" iyz=".003"/></inertial></link><link name="empty"/>
<joint name="hinge" type="revolute"><parent link="stand"/><child link="arm"/><origin xyz=".1 .2 .3" rpy="1.1 0 .3"/><axis xyz="0.6 0 0.8"/>
<limit lower="-1" upper="2" velocity="3" effort="40"/><dynamics damping=".7"/></joint>
<joint name="slide" type="prismatic"><parent link="arm"/><child link="empty"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="2" velocity="3" effort="40"/><mimic joint="hinge" multiplier="2"/></joint></robot>"""
