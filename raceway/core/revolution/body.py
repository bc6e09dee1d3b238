"""A body of revolution: compliances between its nodes, and its natural frequencies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from raceway.core.revolution.factor import condensed, elimination_order, factorised
from raceway.core.revolution.harmonics import offset_weights, solved_harmonics
from raceway.core.revolution.profile import Profile
from raceway.core.revolution.sector import Pencil, Sector
from raceway.errors import MeshError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from scipy.sparse import csr_matrix

#: Hourglass stiffness of "one_point": in the flat elements of a patch ten times more spoils the answer by percents.
HOURGLASS = 0.005
#: Solved harmonics that are added up at once.
_BATCH = 8
#: Above this ratio of all named degrees of freedom to the fewer of loaded and observed ones, systems are solved.
_CONDENSED = 4


class Revolution:
    """A profile swept in equal steps, with its material and seat.

    Parameters
    ----------
    profile : Profile
    divisions : int
        Elements around the body, N; at least 3.
    young, poisson, density : float
        [Pa, -, kg/m3]
    formulation : str
        "incompatible", "full" or "one_point", see ``raceway.core.hexahedron.strain``.
    seat : str or float
        "clamped" (also for a ring that is tied to a rigid frame, in that frame), "free", or the stiffness of an elastic bed
        [N/m3], the same in all three directions, on the cylinder of ``profile.seat``.
    hourglass : float
        Of "one_point".

    Attributes
    ----------
    mass : float
        Of the whole body [kg].

    Notes
    -----
    Answers of a free body are those under loads balanced by uniform acceleration, measured from the rigid motion of its
    masses: the mass-weighted mean of displacement and rotation vanishes.
    """

    def __init__(
        self,
        profile: Profile,
        divisions: int,
        young: float,
        poisson: float,
        density: float,
        formulation: str = "incompatible",
        seat: str | float = "clamped",
        hourglass: float = HOURGLASS,
    ) -> None:
        if divisions < 3:
            raise MeshError(f"a body of revolution needs at least 3 elements around it, not {divisions}")
        self.profile, self.divisions, self.seat = profile, int(divisions), seat
        self.sector = Sector(profile, divisions, young, poisson, density, formulation, hourglass)
        self.mass = float(self.sector.mass.sum() * divisions)
        self._held = np.zeros(3 * len(profile.points), dtype=bool)
        self._springs = np.zeros(3 * len(profile.points))
        if seat == "clamped":
            self._held[(3 * profile.seat[:, None] + np.arange(3)).ravel()] = True
            if not len(profile.seat):
                raise MeshError("a profile without a seat cannot be clamped: seat = 'free'")
        elif isinstance(seat, str):
            if seat != "free":
                raise ValueError(f"seat {seat!r} is neither 'clamped', 'free' nor a stiffness in N/m3")
        elif seat > 0.0:
            areas = seat_areas(profile, divisions)
            for component in range(3):
                self._springs[3 * profile.seat + component] = seat * areas
        else:
            raise MeshError(f"a seat stiffness of {seat:g} N/m3 holds nothing: it must be greater than 0, or 'clamped'")

    @property
    def elements(self) -> int:
        """Hexahedra that the body stands for."""
        return len(self.profile.quads) * self.divisions

    def harmonic(self, n: int) -> Any:
        """(m, m) csc_matrix, the real symmetric system of harmonic n; rows in the order of ``unknowns`` [N/m]."""
        place = self._places(self.unknowns)
        return self._pencil(place).at(2.0 * np.pi * n / self.divisions)

    @property
    def unknowns(self) -> np.ndarray:
        """(m,) degrees of freedom 3 node + component that are not held, ascending."""
        return np.flatnonzero(~self._held)

    def compliance(
        self,
        load_dofs: np.ndarray,
        observed_dofs: np.ndarray,
        offsets: np.ndarray | None = None,
        harmonics: str = "sampled",
    ) -> np.ndarray:
        """Displacements under unit forces, at the offsets that are asked for.

        Parameters
        ----------
        load_dofs, observed_dofs : (k, 2) int
            Node of the profile and component: 0 r, 1 theta, 2 x; see ``profile.dofs``.  A force and a displacement have the
            directions r and theta of their own meridian.
        offsets : (o,) int
            How many sectors the observed meridian lies after the loaded one, towards +theta; None: 0 to N - 1.
        harmonics : str
            "sampled" (error below 1e-8 of the largest compliance of rings that are finest around them, 1e-5 where they
            are coarsest around them) or "all".

        Returns
        -------
        compliance : (o, observed, loads) float [m/N]
            Reversing the offset changes the sign where one of the two components is theta and the other is not.
        """
        load, seen = _flat(load_dofs), _flat(observed_dofs)
        steps = np.arange(self.divisions) if offsets is None else np.atleast_1d(np.asarray(offsets, dtype=np.int64))
        if self._held[load].all() or self._held[seen].all():
            return np.zeros((len(steps), len(seen), len(load)))
        solved = solved_harmonics(self.divisions, harmonics)
        even, odd = offset_weights(self.divisions, solved, steps)
        # u_theta is counted in units of i: i exp(i phase) has the real part -sin, -i exp(i phase) has +sin.
        turn = (load % 3 == 1).astype(float)[None, :] - (seen % 3 == 1).astype(float)[:, None]
        straight = turn == 0.0
        plain = bool(straight.all())
        out = np.zeros((len(steps), len(seen) * len(load)))
        responses = self._responses(load, seen, solved)
        for first in range(0, len(solved), _BATCH):
            part = slice(first, first + _BATCH)
            block = np.stack([next(responses) for _ in solved[part]])
            if plain:
                out += even[:, part] @ block.reshape(len(block), -1)
            else:
                out += even[:, part] @ (block * straight).reshape(len(block), -1)
                out += odd[:, part] @ (block * turn).reshape(len(block), -1)
        return out.reshape(len(steps), len(seen), len(load))

    def frequencies(self, harmonics: Iterable[int], count: int) -> np.ndarray:
        """Natural frequencies.

        Parameters
        ----------
        harmonics : sequence of int
        count : int
            How many of each harmonic, the lowest; those of the rigid motions of a free body (zero) are left out.

        Returns
        -------
        frequencies : (len(harmonics), count) float [Hz], ascending
        """
        from scipy.sparse import diags_array
        from scipy.sparse.linalg import LinearOperator, eigsh

        unknowns = self.unknowns
        mass = np.repeat(self.sector.mass, 3)[unknowns]
        scale = 1.0 / np.sqrt(mass)
        out = []
        for n in harmonics:
            matrix = self.harmonic(int(n))
            scaled = (diags_array(scale) @ matrix @ diags_array(scale)).tocsc()
            rigid = len(self._rigid_motions(int(n))[0]) if self.seat == "free" else 0
            # Far below the elastic eigenvalues, far above the rounding of the largest.
            shift = 1e-9 * float(scaled.diagonal().max())
            factor = factorised(scaled + shift * diags_array(np.ones(len(mass)), format="csc"), ordered=False)
            inverse = LinearOperator(scaled.shape, matvec=factor.solve, dtype=float)
            start = np.random.default_rng(0).standard_normal(len(mass))
            found = eigsh(inverse, count + rigid + 2, which="LM", v0=start, return_eigenvectors=False)
            squares = np.sort(1.0 / found - shift)[rigid : rigid + count]
            out.append(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi))
        return np.array(out)

    def _responses(self, load: np.ndarray, seen: np.ndarray, solved: np.ndarray) -> Any:
        """For each harmonic in turn the (seen, loads) compliance between degrees of freedom 3 node + component [m/N]."""
        both = np.unique(np.concatenate([load, seen]))
        # Condensing costs the cube of the degrees of freedom that stay, solving the number of loads times the whole body.
        small = len(both) <= _CONDENSED * min(len(load), len(seen))
        place = self._places(self._order(both if small else both[:0]))
        pencil = self._pencil(place)
        row_load, row_seen, row_both = place[load], place[seen], place[both]
        held = (row_seen < 0)[:, None] | (row_load < 0)[None, :]
        kept = row_both[row_both >= 0]
        at_load, at_seen = (np.searchsorted(kept, np.maximum(rows, kept[0])) for rows in (row_load, row_seen))
        for n in solved:
            matrix = pencil.at(2.0 * np.pi * n / self.divisions)
            rigid = self._rigid_motions(int(n)) if self.seat == "free" else None
            if rigid is not None and len(rigid[0]):
                found = self._relieved(matrix, rigid, place, row_load, row_seen)
            elif small:
                found = condensed(factorised(matrix), kept)[np.ix_(at_seen, at_load)]
            else:
                found = factorised(matrix).solve(_unit(row_load, len(matrix.indptr) - 1))[row_seen]
            yield np.where(held, 0.0, found) if held.any() else found

    def _relieved(
        self, matrix: csr_matrix, rigid: tuple[np.ndarray, np.ndarray], place: np.ndarray, load: np.ndarray, seen: np.ndarray
    ) -> np.ndarray:
        """Compliance of a free body's harmonic 0 or 1: loads balanced by inertia, no rigid motion of the masses.

        Notes
        -----
        With R the rigid motions, M the masses, P = I - R (R^T M R)^-1 R^T M, it is P K^+ P^T.  As many springs as there
        are rigid motions hold the body without carrying any of a balanced load, so that K + springs may stand for K.
        """
        from scipy.sparse import diags_array

        motions, pins = rigid
        order = np.empty(len(place), dtype=np.int64)
        order[place] = np.arange(len(place))
        r = motions[:, order].T
        inertia = np.repeat(self.sector.mass, 3)[order][:, None] * r
        springs = np.zeros(len(order))
        springs[place[pins]] = matrix.diagonal().mean()
        factor = factorised((matrix + diags_array(springs)).tocsc())
        small = np.linalg.inv(r.T @ inertia)
        moved = factor.solve(inertia)
        far, near = r[seen] @ small, r[load] @ small
        answer = factor.solve(_unit(load, len(order)))[seen]
        return np.asarray(answer - moved[seen] @ near.T - far @ moved[load].T + far @ (inertia.T @ moved) @ near.T)

    def _rigid_motions(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """(q, 3 N) Rigid motions of a harmonic, theta in units of i, and (q,) degrees of freedom that determine them."""
        r, x = self.profile.points.T
        zero, one = np.zeros_like(r), np.ones_like(r)
        pin = 3 * int(np.argmax(r))
        if n == 0:
            return np.stack([_field(zero, zero, one), _field(zero, r, zero)]), np.array([pin + 2, pin + 1])
        if n == 1:
            return np.stack([_field(one, one, zero), _field(x, x, -r)]), np.array([pin, pin + 2])
        return np.empty((0, 3 * len(r))), np.empty(0, dtype=np.int64)

    def _order(self, last: np.ndarray) -> np.ndarray:
        """(m,) Unknowns in an order of little fill, those of ``last`` that are not held at the end, ascending."""
        inside = np.setdiff1d(self.unknowns, last)
        order = inside[elimination_order(self._pencil(self._places(inside)).at(1.0))]
        return np.concatenate([order, last[~self._held[last]]])

    def _places(self, order: np.ndarray) -> np.ndarray:
        """(3 N,) Row of each degree of freedom when ``order`` lists them by rows; -1: held."""
        place = np.full(len(self._held), -1, dtype=np.int64)
        place[order] = np.arange(len(order))
        return place

    def _pencil(self, place: np.ndarray) -> Pencil:
        pencil = self.sector.assembled(self.profile.quads, place)
        if self._springs.any():
            springs = np.zeros(pencil.even.shape[0])
            springs[place[place >= 0]] = self._springs[place >= 0]
            pencil.add_to_diagonal(springs)
        return pencil


def seat_areas(profile: Profile, divisions: int) -> np.ndarray:
    """(k,) Area of the exact cylinder that each seat node of one sector stands for [m2]: linear shape functions along x."""
    if len(profile.seat) < 2:
        raise MeshError("a profile without a seat has no area for an elastic bed")
    r, x = profile.points[profile.seat].T
    length = np.hypot(np.diff(r), np.diff(x))
    # Integral of each linear function times the radius, which is exact for cones, too.
    area = np.zeros(len(r))
    area[:-1] += length * (2.0 * r[:-1] + r[1:]) / 6.0
    area[1:] += length * (r[:-1] + 2.0 * r[1:]) / 6.0
    return np.asarray(area * 2.0 * np.pi / divisions)


def _unit(rows: np.ndarray, size: int) -> np.ndarray:
    """(size, k) Unit loads; a row -1 is held and carries none."""
    out = np.zeros((size, len(rows)))
    free = np.flatnonzero(rows >= 0)
    out[rows[free], free] = 1.0
    return out


def _flat(dofs: np.ndarray) -> np.ndarray:
    pairs = np.asarray(dofs, dtype=np.int64).reshape(-1, 2)
    return np.asarray(3 * pairs[:, 0] + pairs[:, 1])


def _field(r: np.ndarray, theta: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.column_stack([r, theta, x]).ravel()
