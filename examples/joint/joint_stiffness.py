# %% [markdown]
# # The stiffness of a joint
# Two bodies are bolted together and stand on a support. The session has hammer hits on the upper one; the model has the
# weighed masses. The stiffness and damping of the joint follow from the modes.

# %%
import jointbench as jb

folder = jb.example("joint")
session = jb.open(folder / "session.h5")
hits = jb.hits(session)
hits

# %%
modes = jb.modes(hits)
modes

# %% [markdown]
# Two bodies on two links have two modes: enough for the stiffness and damping of both links.

# %%
joint = jb.identify(folder / "bench.toml", folder / "session.h5")
joint

# %%
stiffness = joint["joint.stiffness"]
print(f"{stiffness.value / 1e6:.2f} ± {stiffness.sd / 1e6:.2f} MN/m (true: 60 MN/m)")

# %% [markdown]
# What do the surfaces of the joint let one expect? The fractal parameters of both profiles feed the contact laws.

# %%
surface = jb.surface(folder / "face-a.csv")
surface

# %% [markdown]
# `jointbench report session.h5 --model bench.toml` writes all of this as one HTML page, with the contact law beside the
# identified stiffness.
