# SPDX-License-Identifier: MIT
"""Ours and the peers, each as a function from an FRF and an order to poles.

Peers are the optional extra `benchmarks`; each is imported where it is called, so that
one that is missing stops no other.
"""

from collections.abc import Callable

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.lscf import fit_poles
from jointbench.signal.modal.modes import ModalSettings, identify_modes

# pyOMA2 takes seconds an order; its cost grows with them.
_FEW_ORDERS = 3
Run = Callable[[Frf, int], ComplexArray]


def ours_lscf(frf: Frf, order: int) -> ComplexArray:
    """Poly-reference LSCF, orders 2 to 60."""
    return fit_poles(frf.frequency, frf.response, range(2, order + 1))[-1].pole


def ours_scalar(frf: Frf, order: int) -> ComplexArray:
    """Scalar LSCF, orders 2 to 60: one pole a mode, where peers take two."""
    orders = range(2, order + 1)
    return fit_poles(frf.frequency, frf.response, orders, scalar=True)[-1].pole


def ours_all(frf: Frf, order: int) -> ComplexArray:
    """LSCF, selection, maximum likelihood and covariance."""
    return identify_modes(frf, ModalSettings(highest_order=order)).model.poles


def sdypy(frf: Frf, order: int) -> ComplexArray:
    """sdypy-EMA, scalar LSCF, order to 120; it overwrites its input."""
    from sdypy import EMA

    rows = np.array(frf.response.reshape(-1, frf.frequency.size))
    model = EMA.Model(
        frf=rows,
        freq=np.array(frf.frequency),
        lower=1.0,
        upper=1000.0,
        pol_order_high=2 * order,
        frf_type="accelerance",
    )
    model.get_poles(method="lscf", show_progress=False)
    return np.asarray(model.all_poles[-1], np.complex128)


def sdynpy(frf: Frf, order: int) -> ComplexArray:
    """SDynPy PolyPy, orders 2 to 60; it changes its FRFs in place."""
    import sdynpy as sdp

    outputs = sdp.coordinate_array(np.arange(frf.response.shape[0]) + 1, 3)
    inputs = sdp.coordinate_array([frf.response.shape[0], 14], 3)
    pairs = np.stack(np.broadcast_arrays(outputs[:, None], inputs[None]), axis=-1)
    data = sdp.data_array(
        sdp.data.FunctionTypes.FREQUENCY_RESPONSE_FUNCTION,
        np.array(frf.frequency),
        np.array(frf.response),
        pairs,
    )
    fit = sdp.modal.PolyPy(data)
    fit.compute_poles(np.arange(2, order + 1))
    found = fit.pole_list[0]  # from the highest order down
    omega, ratio = found["omega"], found["zeta"]
    return np.asarray(omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2)))


def pyoma(frf: Frf, order: int) -> ComplexArray:
    """PyOMA2 pLSCF, meant for spectra of responses, fed with the FRFs; three orders."""
    from pyoma2.functions import plscf

    step = 0.5 / float(frf.frequency[-1])
    few = min(order, _FEW_ORDERS)
    denominator, numerator = plscf.pLSCF(np.array(frf.response), step, few)
    poles = plscf.pLSCF_poles(denominator, numerator, step, "per", 2)[3][:, -1]
    return np.asarray(poles[np.isfinite(poles)], np.complex128)


OURS: dict[str, Run] = {
    "jointbench LSCF": ours_lscf,
    "jointbench scalar LSCF": ours_scalar,
    "jointbench LSCF + ML + covariance": ours_all,
}
PEERS: dict[str, Run] = OURS | {
    "sdypy-EMA": sdypy,
    "SDynPy PolyPy": sdynpy,
    "pyOMA2 pLSCF, 3 orders": pyoma,
}
