# %% [markdown]
# # A first mode
# Three hammer hits on a block were recorded as .csv files: time, force and acceleration, with the units in the header.
# This tutorial finds the natural frequencies and damping ratios, with intervals.

# %%
import jointbench as jb

folder = jb.example("hits")
files = sorted(folder.glob("hit*.csv"))
session = jb.open(files)
session

# %% [markdown]
# Every hit is judged: a double hit, an overload or a weak hit would be left out, with the reason.

# %%
hits = jb.hits(session)
hits

# %% [markdown]
# The FRF is the acceleration over the force. Its coherence shows where noise matters.

# %%
frf = jb.frf(hits)
frf

# %% [markdown]
# Modes are fitted to the FRF. Each has a natural frequency and a damping ratio with standard deviations.

# %%
modes = jb.modes(frf)
modes

# %% [markdown]
# The true values of this simulated block are 197.969 Hz and 722.486 Hz.

# %%
model = modes.chain.result.model
for f, sd in zip(model.natural_frequency, model.frequency_sd, strict=True):
    print(f"{f:.3f} Hz, 95 %: {f - 1.96 * sd:.3f} to {f + 1.96 * sd:.3f} Hz")
