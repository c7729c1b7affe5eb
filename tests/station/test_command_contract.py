"""Commands and options of version 0.1.0, all of which are still accepted."""

import typer
from typer.core import TyperGroup

from jointbench.station.main import app

FIRST_VERSION = """
demo: --debug --json --out --seed
record: --debug --force --json --out
import: --columns --debug --force --full-scale --json --out --point --preload
modal: --band --columns --debug --drop --estimator --json --keep --order --out
    --output-only --point --uff
surface: --columns --debug --json
measure: --debug --force --json --out --source
calibrate: --debug --json --mass --mass-sd
profile: --baud --debug --filtered --force --json --name --out --session --traverse
    --unsigned
simulate: --debug
contact: --bolt-diameter --bolts --columns --debug --dimension --dimension-sd
    --frequency --friction --friction-factor --friction-factor-sd --hardness
    --hardness-sd --json --load --loss-convention --loss-form --mass --mode --model
    --modulus --nominal-area --nut-factor --nut-factor-sd --plot --poisson --real-area
    --roughness --roughness-sd --stiffness --surface --sweep --tangential-load
    --torque --without --yield-strength
identify: --band --cache --debug --json --report --surface
gap: --debug --effects --json --model --preload --report --without
process: --again --debug --json --out --recipe --stages
reprocess: --again --batch --debug --jobs --json --ledger --recipe --results --retries
    --scheduler --stages --stages-limit --time-limit --tls-ca --tls-cert --tls-key
archive: --debug --json --out --trend
compare: --debug --json
export: --debug --json --out --to
report: --debug --geometry --json --model --out
inspect: --debug --json
verify: --debug --json
recover: --debug --force --json --out
"""


def accepted() -> dict[str, set[str]]:
    """Return the options of each command."""
    group = typer.main.get_command(app)
    assert isinstance(group, TyperGroup)
    return {
        name: {text for one in command.params for text in one.opts}
        for name, command in group.commands.items()
    }


def test_every_command_and_option_of_the_first_version_is_accepted() -> None:
    """Scripts written for it run without a change."""
    now = accepted()
    name = ""
    for word in FIRST_VERSION.split():
        if word.endswith(":"):
            name = word.removesuffix(":")
            assert name in now
        else:
            assert word in now[name], f"{name} {word}"
