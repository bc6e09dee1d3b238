"""A body of revolution: compliances between its nodes, and its natural frequencies."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.fem.hexahedron.operator import HexOperator
from raceway.core.fem.revolution.sections import Profile
from raceway.errors import MeshError
from raceway.storage.array_cache import kept
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import SuperLU


class _Sector:
    """One sector of a body of N equal ones: element matrices and masses.

    even, cosine, sine : (M, 12, 12) parts A, B, S of the quadrilaterals' matrices, component by component of their four nodes [N/m]
    mass : (N,) lumped masses of the nodes of one meridian [kg]

    With u_k = u exp(i n k a), a = 2 pi / N, the stiffness of a ring of equal sectors becomes
    K(n) = D + U exp(i n a) + U^T exp(-i n a) in nodal components r, theta, x; D couples nodes of one meridian, U those of
    neighbouring ones.  The sector is its own mirror image, so that K(n) is real once u_theta is counted in units of i:
    K(n) = A + B cos(n a) + S sin(n a), where A and B couple r and x among themselves and theta with theta, S the two groups.
    """

    def __init__(self, body: Revolution) -> None:
        profile = body.profile
        half, count = np.pi / body.divisions, len(profile.points)
        r, x = profile.points.T
        c, s = np.cos(half), np.sin(half)
        points = np.concatenate([np.column_stack([x, c * r, -s * r]), np.column_stack([x, c * r, s * r])])
        cells = np.concatenate([profile.quads, profile.quads + count], axis=1)
        operator = HexOperator(points, cells, body.young, body.poisson, body.density, body.formulation, body.hourglass)
        # Columns: r, theta, x of the nodes on either side in x, y, z.
        sides = np.stack([_frame(-half)] * 4 + [_frame(half)] * 4)
        elements = operator.element_stiffness(slice(0, len(cells))).reshape(-1, 8, 3, 8, 3)
        k = np.einsum("iab,eiajc,jcd->eibjd", sides, elements, sides, optimize=True)
        first, second = slice(0, 4), slice(4, 8)
        near = k[:, first, :, first] + k[:, second, :, second]
        far, back = k[:, first, :, second], np.einsum("eiajb->ejbia", k[:, first, :, second])
        alike = np.ones((3, 3), dtype=bool)
        alike[1, [0, 2]] = alike[[0, 2], 1] = False
        # conj(w_a) w_b with w = 1 for r and x, i for theta: +i couples r and x to theta, -i theta to r and x.
        sign = np.array([[0, -1, 0], [1, 0, 1], [0, -1, 0]], dtype=float)
        size = (-1, 12, 12)
        self.even = (near * alike[:, None, :]).reshape(size)
        self.cosine = ((far + back) * alike[:, None, :]).reshape(size)
        self.sine = ((far - back) * sign[:, None, :]).reshape(size)
        masses = operator.element_masses
        self.mass = np.bincount(profile.quads.ravel(), weights=(masses[:, :4] + masses[:, 4:]).ravel(), minlength=count)

    def assembled(self, quads: np.ndarray, row: np.ndarray) -> _Pencil:
        """The sector's matrices with the degree of freedom 3 node + component in row ``row`` (-1: held)."""
        from scipy.sparse import coo_matrix

        number = row[(3 * quads[:, :, None] + np.arange(3)).reshape(len(quads), 12)]
        rows = np.broadcast_to(number[:, :, None], self.even.shape).ravel()
        columns = np.broadcast_to(number[:, None, :], self.even.shape).ravel()
        free = (rows >= 0) & (columns >= 0)
        rows, columns, size = rows[free], columns[free], int(row.max()) + 1

        def total(part: np.ndarray) -> csr_matrix:
            return coo_matrix((part.ravel()[free], (rows, columns)), shape=(size, size)).tocsc()

        return _Pencil(total(self.even), total(self.cosine).data, total(self.sine).data)


class _Pencil:
    """K(n) = A + B cos(n a) + S sin(n a) in one sparsity pattern."""

    def __init__(self, even: csr_matrix, cosine: np.ndarray, sine: np.ndarray) -> None:
        self.even, self.cosine, self.sine = even, cosine, sine

    def at(self, angle: float) -> csr_matrix:
        """(m, m) scipy.sparse.csc_matrix of the harmonic with n a = ``angle``."""
        from scipy.sparse import csc_matrix

        data = self.even.data + np.cos(angle) * self.cosine + np.sin(angle) * self.sine
        return csc_matrix((data, self.even.indices, self.even.indptr), shape=self.even.shape)


def _frame(angle: float) -> np.ndarray:
    """(3, 3) Columns: directions r, theta, x at an azimuth from y towards z, in x, y, z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[0.0, 0.0, 1.0], [c, -s, 0.0], [s, c, 0.0]])


#: A symmetric elimination: pivots stay on the diagonal.
_SYMMETRIC: Tables = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}


def symmetric_factors(matrix: csr_matrix, ordered: bool = True) -> SuperLU:
    """scipy.sparse.linalg.SuperLU of a symmetric csc_matrix; ``ordered``: its rows already stand in an order of little fill."""
    from scipy.sparse.linalg import splu

    return splu(matrix, permc_spec="NATURAL" if ordered else "MMD_AT_PLUS_A", **_SYMMETRIC)


def _schur_inverse(factor: SuperLU, boundary: np.ndarray) -> np.ndarray:
    """(s, s) The rows and columns ``kept`` of the inverse, where they are the last ones of the matrix that was factorised.

    With K = L D L^T the last block of L D L^T is the condensed stiffness, and its inverse that block of K^-1.  SuperLU may
    renumber along the elimination tree, which changes no entry of the factors.
    """
    position = factor.perm_c[boundary]
    by_place = np.argsort(position)
    lower, upper = factor.L, factor.U
    row = np.full(lower.shape[0], -1)
    row[position[by_place]] = np.arange(len(boundary))
    block = np.zeros((len(boundary), len(boundary)))
    for column, at in enumerate(position[by_place]):
        part = slice(lower.indptr[at], lower.indptr[at + 1])
        rows = row[lower.indices[part]]
        block[rows[rows >= 0], column] = lower.data[part][rows >= 0]
    from scipy.linalg import solve_triangular

    inverse = solve_triangular(
        block, np.eye(len(boundary)), lower=True, unit_diagonal=True, overwrite_b=True, check_finite=False
    )
    pivots = upper.diagonal()[position[by_place]]
    compliance = inverse.T @ (inverse / pivots[:, None])
    out = np.empty_like(compliance)
    out[np.ix_(by_place, by_place)] = compliance
    return out


#: All harmonics up to DENSE are solved.  Beyond, each is at most RATIO times the one before, and at most N / 2 / STEPS above
#: it: towards N / 2, where elements are half a wave long, C(n) varies with n / N and not with log n.
DENSE, RATIO, STEPS = 12, 1.2, 24


def solved_harmonics(divisions: int, harmonics: str) -> np.ndarray:
    """(s,) harmonics from 0 to N // 2 that are solved: "sampled", or "all"."""
    last = divisions // 2
    if harmonics == "all":
        return np.arange(last + 1)
    if harmonics != "sampled":
        raise ValueError(f"harmonics {harmonics!r} is neither 'sampled' nor 'all'")
    orders = list(range(min(DENSE, last) + 1))
    while orders[-1] < last:
        step = int(min((RATIO - 1.0) * orders[-1], last / STEPS))
        orders.append(min(last, orders[-1] + max(step, 1)))
    return np.array(orders)


def offset_weights(divisions: int, harmonics: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights of the solved harmonics at offsets in whole sectors, (offsets, s) of the cosine and of the sine part.

    A unit force at azimuth 0 is the sum of all harmonics with weight 1/N, N the number of sectors. The compliance C(n) is a
    smooth function of n, so it is solved at few n; (1 + n) C as a function of log(1 + n/8) is interpolated by a spline of
    degree 5. The spline is linear in its data, so that sum over n of C(n) cos(2 pi n k / N) is a sum over the solved
    harmonics alone. Harmonics 0 and 1, which differ from the others where a body can move rigidly, take no part in the
    spline.
    """
    n = np.arange(divisions // 2 + 1)
    share = np.full(len(n), 2.0 / divisions)
    share[0] = 1.0 / divisions
    if divisions % 2 == 0:
        share[-1] = 1.0 / divisions
    # n k reduced by whole turns in integers, so that large products lose no digits.
    phase = 2.0 * np.pi / divisions * (np.outer(offsets, n) % divisions)
    even, odd = share * np.cos(phase), share * np.sin(phase)
    if len(harmonics) == len(n):
        return even, odd
    spread = np.zeros((len(n), len(harmonics)))
    spread[n[: DENSE + 1], n[: DENSE + 1]] = 1.0
    # The interpolating spline for unit data
    harmonics, orders = harmonics[2:], n[DENSE + 1 :]
    from scipy.interpolate import make_interp_spline

    unit = make_interp_spline(np.log1p(harmonics / 8.0), np.eye(len(harmonics)), k=5)(np.log1p(orders / 8.0))
    spread[DENSE + 1 :, 2:] = np.asarray(unit * (1.0 + harmonics)[None, :] / (1.0 + orders)[:, None])
    return even @ spread, odd @ spread


def groove_compliance(angles: np.ndarray, response: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """M (k, 3) by least squares over all pairs of angles: axial by axial, axial by radial and radial by radial force [m/N].

    angles : (n,) contact angles [rad];  weight : (n,) of each
    response : (n, n, k) displacement along the normal at one angle by a unit force along that at another [m/N]

    A groove whose section turns about its centre is the same groove, and the force of a contact goes through that centre: a
    contact at the angle b feels n(b).M n(a) of a unit force at the angle a, n = (sin, cos). Displacements of a surface point
    hold that turn and are not what the contact feels.
    """
    pairs = np.outer(weight, weight)
    columns = _unit_columns(angles[:, None], angles) * pairs
    values = (response * pairs[:, :, None]).reshape(-1, response.shape[2])
    return np.asarray(np.linalg.lstsq(columns.reshape(3, -1).T, values, rcond=None)[0].T)


def direct_compliance(angles: np.ndarray, response: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """M (3,) of a contact on itself, from response (n,) at the angle of the force itself; else as ``groove_compliance``."""
    columns = _unit_columns(angles, angles) * weight
    return np.asarray(np.linalg.lstsq(columns.T, response * weight, rcond=None)[0])


def along_normal(angles: np.ndarray, compliance: np.ndarray) -> np.ndarray:
    """(n,) n.M n at contact angles [m/N], from M (3,)."""
    return np.asarray(compliance @ _unit_columns(angles, angles))


def _unit_columns(angle: np.ndarray, load_angle: np.ndarray) -> np.ndarray:
    """(3, ...) what the three numbers of M are multiplied by in n.M n'."""
    return np.stack([np.sin(angle) * np.sin(load_angle), np.sin(angle + load_angle), np.cos(angle) * np.cos(load_angle)])


#: The code on which the numbers depend; whoever keeps something made of compliances adds its own.
SOURCES = ("core/fem/revolution", "core/fem/hexahedron")
#: Hourglass stiffness of "one_point": in the flat elements of a patch ten times more spoils the answer by percents.
HOURGLASS = 0.005
#: Solved harmonics that are added up at once.
_BATCH = 8
#: Above this ratio of all named degrees of freedom to the fewer of loaded and observed ones, systems are solved.
_CONDENSED = 4


@attrs.frozen(eq=False)
class Revolution:
    """A profile swept in equal steps, with its material and seat.

    Answers of a free body are those under loads balanced by uniform acceleration, measured from the rigid motion of its
    masses: the mass-weighted mean of displacement and rotation vanishes.
    """

    profile: Profile
    divisions: int  # elements around the body, N; at least 3
    #: young, poisson, density : [Pa, -, kg/m3]
    young: float
    poisson: float
    density: float = 1.0
    formulation: str = "incompatible"  # "incompatible", "full" or "one_point", see ``raceway.core.fem.hexahedron.strain``
    #: "clamped" (also for a ring that is tied to a rigid frame, in that frame), "free", or the stiffness of an elastic bed
    #: [N/m3], the same in all three directions, on the cylinder of ``profile.seat``
    seat: str | float = "clamped"
    hourglass: float = HOURGLASS  # of "one_point"
    _held: np.ndarray = attrs.field(init=False)
    _springs: np.ndarray = attrs.field(init=False)

    @_held.default
    def _held_dofs(self) -> np.ndarray:
        fixed = np.zeros(3 * len(self.profile.points), dtype=bool)
        if self.divisions < 3:
            raise MeshError(f"a body of revolution needs at least 3 elements around it, not {self.divisions}")
        if isinstance(self.seat, str) and self.seat not in ("clamped", "free"):
            raise ValueError(f"seat {self.seat!r} is neither 'clamped', 'free' nor a stiffness in N/m3")
        if self.seat == "clamped":
            if not len(self.profile.seat):
                raise MeshError("a profile without a seat cannot be clamped: seat = 'free'")
            fixed[(3 * self.profile.seat[:, None] + np.arange(3)).ravel()] = True
        return fixed

    @_springs.default
    def _bed(self) -> np.ndarray:
        springs = np.zeros(3 * len(self.profile.points))
        if isinstance(self.seat, str):
            return springs
        if not self.seat > 0.0:
            raise MeshError(f"a seat stiffness of {self.seat:g} N/m3 holds nothing: it must be greater than 0, or 'clamped'")
        for component in range(3):
            springs[3 * self.profile.seat + component] = self.seat * seat_areas(self.profile, self.divisions)
        return springs

    @cached_property
    def sector(self) -> _Sector:
        """One of the equal sectors."""
        return _Sector(self)

    @property
    def mass(self) -> float:
        """Of the full body [kg]."""
        return float(self.sector.mass.sum() * self.divisions)

    @property
    def elements(self) -> int:
        """Hexahedra that the body stands for."""
        return len(self.profile.quads) * self.divisions

    def harmonic(self, n: int) -> csr_matrix:
        """(m, m) csc_matrix, the real symmetric system of harmonic n; rows in the order of ``unknowns`` [N/m]."""
        return self._pencil(self._places(self.unknowns)).at(2.0 * np.pi * n / self.divisions)

    @property
    def unknowns(self) -> np.ndarray:
        """(m,) degrees of freedom 3 node + component that are not held, ascending."""
        return np.flatnonzero(~self._held)

    def compliance(
        self, load_dofs: np.ndarray, observed_dofs: np.ndarray, offsets: np.ndarray | None = None, harmonics: str = "sampled"
    ) -> np.ndarray:
        """Displacements (o, observed, loads) under unit forces [m/N], at the offsets that are asked for.

        load_dofs, observed_dofs : (k, 2) node of the profile and component, 0 r, 1 theta, 2 x, see ``dofs``; forces and displacements
            have the directions r and theta of their own meridian
        offsets : (o,) sectors from the loaded meridian to the observed one, towards +theta; None: 0 to N - 1
        harmonics : "sampled" (error below 1e-8 of the largest compliance of rings that are finest around them, 1e-5 where they are
            coarsest around them) or "all"

        Reversing the offset changes the sign where one of both components is theta
        """
        load, outputs = _flat(load_dofs), _flat(observed_dofs)
        steps = np.arange(self.divisions) if offsets is None else np.atleast_1d(np.asarray(offsets, dtype=np.int64))
        if self._held[load].all() or self._held[outputs].all():
            return np.zeros((len(steps), len(outputs), len(load)))
        solved = solved_harmonics(self.divisions, harmonics)
        even, odd = offset_weights(self.divisions, solved, steps)
        # u_theta is counted in units of i: i exp(i phase) has the real part -sin, -i exp(i phase) has +sin.
        turn = (load % 3 == 1).astype(float)[None, :] - (outputs % 3 == 1).astype(float)[:, None]
        straight = turn == 0.0
        plain = bool(straight.all())
        out = np.zeros((len(steps), len(outputs) * len(load)))
        responses = self._responses(load, outputs, solved)
        for first in range(0, len(solved), _BATCH):
            part = slice(first, first + _BATCH)
            block = np.stack([next(responses) for _ in solved[part]])
            if plain:
                out += even[:, part] @ block.reshape(len(block), -1)
            else:
                out += even[:, part] @ (block * straight).reshape(len(block), -1)
                out += odd[:, part] @ (block * turn).reshape(len(block), -1)
        return out.reshape(len(steps), len(outputs), len(load))

    def cached_compliance(
        self,
        label: str,
        load_dofs: np.ndarray,
        observed_dofs: np.ndarray,
        offsets: np.ndarray | None = None,
        harmonics: str = "sampled",
    ) -> np.ndarray:
        """``compliance`` [m/N], read-only when it comes from the cache, where ``raceway dev cache`` shows the label."""
        inputs = {
            "points": self.profile.points,
            "quads": self.profile.quads,
            "seat_nodes": self.profile.seat if self.seat != "free" else None,
            "divisions": self.divisions,
            "young": float(self.young),
            "poisson": float(self.poisson),
            "loads": np.asarray(load_dofs, dtype=np.int64),
            "observed": np.asarray(observed_dofs, dtype=np.int64),
            "offsets": None if offsets is None else np.asarray(offsets, dtype=np.int64),
            "formulation": self.formulation,
            "hourglass": self.hourglass if self.formulation == "one_point" else None,
            "seat": self.seat,
            "harmonics": harmonics,
        }

        def make() -> dict[str, np.ndarray]:
            return {"compliance": self.compliance(load_dofs, observed_dofs, offsets, harmonics)}

        return kept("compliance", label, inputs, SOURCES, make)["compliance"]

    def frequencies(self, harmonics: Iterable[int], count: int) -> np.ndarray:
        """Natural frequencies (len(harmonics), count) [Hz], ascending.

        count : how many of each harmonic, the lowest; those of the rigid motions of a free body (zero) are left out
        """
        from scipy.sparse import diags_array
        from scipy.sparse.linalg import LinearOperator, eigsh

        mass = np.repeat(self.sector.mass, 3)[self.unknowns]
        scale = 1.0 / np.sqrt(mass)
        out = []
        for n in harmonics:
            unit_diagonal = (diags_array(scale) @ self.harmonic(int(n)) @ diags_array(scale)).tocsc()
            rigid = len(self._rigid_motions(int(n))[0]) if self.seat == "free" else 0
            # Far below the elastic eigenvalues, far above the rounding of the largest.
            shift = 1e-9 * float(unit_diagonal.diagonal().max())
            factor = symmetric_factors(unit_diagonal + shift * diags_array(np.ones(len(mass)), format="csc"), ordered=False)
            inverse = LinearOperator(unit_diagonal.shape, matvec=factor.solve, dtype=float)
            start = np.random.default_rng(0).standard_normal(len(mass))
            eigenvalues = eigsh(inverse, count + rigid + 2, which="LM", v0=start, return_eigenvectors=False)
            squares = np.sort(1.0 / eigenvalues - shift)[rigid : rigid + count]
            out.append(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi))
        return np.array(out)

    def _responses(self, load: np.ndarray, outputs: np.ndarray, harmonics: np.ndarray) -> Iterator[np.ndarray]:
        """For each harmonic in turn the (seen, loads) compliance between degrees of freedom 3 node + component [m/N]."""
        both = np.unique(np.concatenate([load, outputs]))
        # Condensing costs the cube of the degrees of freedom that stay, solving the number of loads times the whole body.
        small = len(both) <= _CONDENSED * min(len(load), len(outputs))
        # Unknowns in an order of little fill, those that stay at the end, ascending.
        last = both if small else both[:0]
        inside = np.setdiff1d(self.unknowns, last)
        order = inside[np.argsort(symmetric_factors(self._pencil(self._places(inside)).at(1.0), ordered=False).perm_c)]
        row = self._places(np.concatenate([order, last[~self._held[last]]]))
        pencil = self._pencil(row)
        row_load, row_seen, row_both = row[load], row[outputs], row[both]
        fixed = (row_seen < 0)[:, None] | (row_load < 0)[None, :]
        boundary = row_both[row_both >= 0]
        at_load, at_seen = (np.searchsorted(boundary, np.maximum(rows, boundary[0])) for rows in (row_load, row_seen))
        for n in harmonics:
            matrix = pencil.at(2.0 * np.pi * n / self.divisions)
            rigid = self._rigid_motions(int(n)) if self.seat == "free" else None
            if rigid is not None and len(rigid[0]):
                response = self._free_compliance(matrix, rigid, row, row_load, row_seen)
            elif small:
                response = _schur_inverse(symmetric_factors(matrix), boundary)[np.ix_(at_seen, at_load)]
            else:
                response = symmetric_factors(matrix).solve(_unit_loads(row_load, len(matrix.indptr) - 1))[row_seen]
            yield np.where(fixed, 0.0, response) if fixed.any() else response

    def _free_compliance(
        self,
        matrix: csr_matrix,
        rigid: tuple[np.ndarray, np.ndarray],
        row: np.ndarray,
        load: np.ndarray,
        outputs: np.ndarray,
    ) -> np.ndarray:
        """Compliance of a free body's harmonic 0 or 1: loads balanced by inertia, no rigid motion of the masses.

        With R the rigid motions, M the masses, P = I - R (R^T M R)^-1 R^T M, it is P K^+ P^T.  As many springs as there
        are rigid motions hold the body without carrying any of a balanced load, so that K + springs may stand for K.
        """
        from scipy.sparse import diags_array

        motions, pins = rigid
        order = np.empty(len(row), dtype=np.int64)
        order[row] = np.arange(len(row))
        r = motions[:, order].T
        inertia = np.repeat(self.sector.mass, 3)[order][:, None] * r
        springs = np.zeros(len(order))
        springs[row[pins]] = matrix.diagonal().mean()
        factor = symmetric_factors((matrix + diags_array(springs)).tocsc())
        small = np.linalg.inv(r.T @ inertia)
        relief = factor.solve(inertia)
        far, near = r[outputs] @ small, r[load] @ small
        answer = factor.solve(_unit_loads(load, len(order)))[outputs]
        return np.asarray(answer - relief[outputs] @ near.T - far @ relief[load].T + far @ (inertia.T @ relief) @ near.T)

    def _rigid_motions(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """(q, 3 N) Rigid motions of a harmonic, theta in units of i, and (q,) degrees of freedom that determine them."""
        r, x = self.profile.points.T
        zero, unit = np.zeros_like(r), np.ones_like(r)
        pin = 3 * int(np.argmax(r))
        if n == 0:
            return np.stack([_field(zero, zero, unit), _field(zero, r, zero)]), np.array([pin + 2, pin + 1])
        if n == 1:
            return np.stack([_field(unit, unit, zero), _field(x, x, -r)]), np.array([pin, pin + 2])
        return np.empty((0, 3 * len(r))), np.empty(0, dtype=np.int64)

    def _places(self, order: np.ndarray) -> np.ndarray:
        """(3 N,) Row of each degree of freedom when ``order`` lists them by rows; -1: held."""
        row = np.full(len(self._held), -1, dtype=np.int64)
        row[order] = np.arange(len(order))
        return row

    def _pencil(self, row: np.ndarray) -> _Pencil:
        pencil = self.sector.assembled(self.profile.quads, row)
        if self._springs.any():
            springs = np.zeros(pencil.even.shape[0])
            springs[row[row >= 0]] = self._springs[row >= 0]
            matrix = pencil.even  # of every harmonic
            columns = np.repeat(np.arange(matrix.shape[1]), np.diff(matrix.indptr))
            matrix.data[matrix.indices == columns] += springs
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


def _unit_loads(rows: np.ndarray, size: int) -> np.ndarray:
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
