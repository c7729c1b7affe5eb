# %% [markdown]
# # A year's archive
# One joint was measured every second month, at two torques. Has it changed?

# %%
from datetime import UTC, datetime

import jointbench as jb

folder = jb.example("archive")
sessions = sorted(folder.glob("2025-*/*.h5"))
sessions = [path for path in sessions if not path.name.endswith(".results.h5")]
len(sessions)

# %% [markdown]
# Every session is processed with the same recipe. The results lie beside the sessions; `jointbench reprocess` does the
# same for thousands of sessions, with several processes.

# %%
results = [jb.process(path, folder / "narrow.toml") for path in sessions]
results[0]

# %%
archive = jb.archive(folder)
archive

# %% [markdown]
# The second natural frequency, that of the joint, at the lower torque:

# %%
rows = [
    row
    for row in archive.rows
    if (row.name, row.item, row.torque) == ("natural_frequency", "2", 20.0)
]
for row in sorted(rows, key=lambda one: one.day):
    day = datetime.fromtimestamp(row.day * 86_400, UTC).date()
    print(f"{day}  {row.value:.3f} ± {row.sd:.3f} Hz")

# %% [markdown]
# It falls: the joint has lost about 1 % of its stiffness a month. `jointbench archive ... --trend day` fits it at
# each torque and tests it.

# %%
archive.write("all.csv")
