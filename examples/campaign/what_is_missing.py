# %% [markdown]
# # What is missing
# A linear model of a bench disagrees with hammer hits at several levels, points and preloads. Which effect does it lack?

# %%
import jointbench as jb

folder = jb.example("campaign")
campaign = jb.open(folder / "session.h5")
print(campaign.preloads, "N;", len(campaign.recordings), "hits")

# %% [markdown]
# `gap` fits the model with its priors, tests every effect of the catalogue, and checks the best one on hits that were
# not used for the fit. It takes some seconds.

# %%
found = jb.gap(folder / "session.h5", model=folder / "bench.toml")
found

# %%
print(found.verdict, found.effects)

# %% [markdown]
# The verdict is "named": a cubic stiffness in the joint, which is what the simulator hides. The report shows where the
# gap is and what else was tried.

# %%
found.write_report("gap.html")
