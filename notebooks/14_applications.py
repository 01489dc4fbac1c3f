# ---
# jupyter:
#   jupytext:
#     formats: ipynb,py:percent
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # What it is good for (Section 8, Figures 19 and 20)
#
# A line passes through holes that no body fits through, and packs into capsules. Section 8 tells of
# endoscopes, tombs, rockets and robots. Which of these can be shown, and what does a motor say?

# %%
import os
import tempfile

import pandas as pd

import lineup as lu
from lineup import draw

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 88}}

# %% [markdown]
# ## Through a tube, and something else beyond it (Figure 20)
#
# In Figure 20 a device goes into a patient's mouth in one shape, through the esophagus as a line,
# and is another shape in the stomach. Here the body is a wall, and the esophagus a curved tube in
# it. The chain *glides*: its end leads, and everything behind follows in its track, as a snake
# does. "A line configuration can be easily driven by a single actuator placed at the head", says
# Section 8. The blocks are thinner for this, .914 of a voxel, for a chain that glides cuts corners.

# %%
blocks = 60 if os.environ.get("LINEUP_QUICK") else 240
solids = [lu.model(name, voxels=round(2.16 * blocks)) for name in ("elephant", "bunny")]
elephant, bunny = (lu.fold(solid, "pull", length=2 * blocks) for solid in solids)
surgery = lu.through_tube(elephant, bunny, radius=2.2)
assert len(surgery.motion.start) == 2 * blocks
assert surgery.certificate.ok
draw.run(surgery)

# %% [markdown]
# The wall is cut open in the pictures, not in the run. It is made of unit voxels, and the judge
# knows about them: no block meets the wall or another block, at any instant, or it would say where.

# %%
print(surgery.certificate.reason, surgery.certificate.clearance)
narrow = lu.through_tube(elephant, bunny, radius=0.6)
assert not len(narrow.motion)
print(narrow.motion.reason)

# %% [markdown]
# A failure is a result, too: in a tube narrower than a block there is no way.

# %% [markdown]
# ## Into the tomb (archaeology)
#
# The same, but the chain comes as a straight line and not as a shape: "send it inside the target
# (e.g., sealed tomb) through a tiny hole. After that, it can be transformed into a probing device".
# The hole is 4.4 voxels wide, the bunny beyond it wider in every direction.

# %%
tomb = lu.through_tube(None, bunny, radius=2.2)
assert tomb.certificate.ok
assert min(bunny.path.voxels.max(axis=0) - bunny.path.voxels.min(axis=0) + 1) > 2 * tomb.radius
draw.run(tomb)

# %% [markdown]
# ## Into the capsule (aerospace)
#
# "It is highly demanded to pack it in a compact form so that it can fit into a small capsule of the
# launch vehicle." A capsule with a port that is only as large as it has to be; the chain comes in
# by the port and fills it.

# %%
size = (2.9, 7.0) if os.environ.get("LINEUP_QUICK") else (4.5, 13.0)
launch = lu.into_capsule(*size)
assert launch.certificate.ok
line, packed = (len(launch.motion.start), launch.motion.goal.max(0) - launch.motion.goal.min(0) + 1)
assert max(packed) < line
print(f"a line of {line} voxels, packed into {' x '.join(map(str, packed))}")
draw.run(launch)

# %% [markdown]
# At the size of the paper's chains, from `python -m benchmarks.scenarios`:

# %%
runs = pd.read_csv("../experiments/results/scenarios.csv").set_index("scenario")
assert (runs["certified"] == "certified").all()
assert (runs["blocks"] >= 635).all()
assert (runs["clearance"] >= runs["diameter"]).all()
runs[["blocks", "radius", "pulls", "diameter", "bend_deg", "clearance"]]

# %% [markdown]
# ## A robot (Figure 19)
#
# Replace each block by a module with five motors: one twists it about x, two turn about y, two
# about z. That is the paper's design of a *self-reconfigurable modular robot*. We write the chain
# as a robot for simulators: URDF and MuJoCo files with five joints a block, and the motion as a
# table of joint angles.

# %%
design = lu.lineup(["duck"], blocks=40)
(duck,) = design.foldings
robot = lu.export_robot(duck, tempfile.mkdtemp(), pitch_mm=60)
urdf = robot.files[0].read_text()
assert urdf.count('type="revolute"') + urdf.count('type="continuous"') == 5 * 40
assert robot.survey.held_nm.shape == (40, 5)
print(", ".join(file.name for file in robot.files))

# %% [markdown]
# The angles really do it: follow them, and the robot ends as the straight line, as far as numbers
# can tell.

# %%
(turns,) = lu.robot.angles_at(robot.survey.trajectory, [len(duck.motion)])
pose, _ = lu.robot.chain_pose(turns, robot.survey.origin, robot.survey.frame)
span = ((pose[-1] - pose[0]) ** 2).sum() ** 0.5
assert abs(span - 79) < 1e-6
assert robot.survey.deviation < 1e-6
print(f"ends {span:.0f} voxels apart after the last move, of 79 possible")

# %% [markdown]
# ## What the motors say
#
# "The current bottleneck of autonomous transformation taken on these SRMRs is the small
# power-to-weight ratio on actuators." In numbers: to hold all that hangs on it, the worst joint of
# this small duck asks for so much torque for each kilogram of motor, if motors are half of the
# weight. Beside it what four servos give, by their maker's data.

# %%
motors = robot.actuators.set_index("actuator")
torque = motors[["torque_per_kg", "held_per_kg"]]
torque.columns = ["gives", "has to hold"]
assert (motors["short_held"] > 10).all()
draw.dots(
    torque,
    "torque, newton metres for each kilogram of motor",
    "A duck of 40 blocks of 60 mm",
    log=True,
)

# %% [markdown]
# Too little by a factor of 50 to 100. And that is a duck of 40 blocks, with its line clamped in the
# middle; a level line asks for more with the square of its length. None of these motors could hold
# a line of many blocks:

# %%
assert motors["level_blocks"].max() < 40
motors[["short_held", "short_power", "level_blocks", "largest_gravity"]].round(3)

# %% [markdown]
# *level_blocks* is how long a level line may be, and *largest_gravity* in m/s² how strong gravity
# may be for this duck to work. The paper goes on: "this problem does not exist in the environment
# with small or even no gravity such as underwater or in outer space." By these numbers gravity may
# be up to a tenth of a metre a second squared, one hundredth of the Earth's: that of a small
# asteroid. Between the two:

# %%
weightless = lu.export_robot(duck, tempfile.mkdtemp(), pitch_mm=60, gravity=0.05)
assert (weightless.actuators["short_held"] < 1).all()
print(weightless.actuators["short_held"].round(2).tolist())

# %% [markdown]
# ## Spatial ability training
#
# The first use in Section 8 is that people get better at turning things in their minds. Nothing
# here can show that. What we can give is the exercise: graded manuals (notebook 10), from very easy
# to very hard.

# %% [markdown]
# ## Where this differs from the paper
#
# - Figure 20 is an illustration; these are runs past obstacles that are judged. The paper's motion
#   does not know of obstacles.
#
# - Gliding takes blocks thinner than a voxel, and joints that bend in any plane: the block
#   `lu.BLOCKS["pull"]`, and not the one of Figure 16.
#
# - The torques are those of rest, of a chain that is clamped in the middle and touches nothing. A
#   robot that rests on the ground has an easier life.
#
# - The electronics of Figure 19, the connectors between modules, and any test on people are left
#   out: by the paper as future work, and by us altogether.
#
# - Next, in 15 and 16: what the paper left for later. Or go back to 00, and read the overview with
#   other eyes.
