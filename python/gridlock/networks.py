"""Networks of a model: edges between agents, which these keep wherever they move."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .arrays import as_array, as_count, as_number, as_numbers, in_short, named_in_short
from .converters import library
from .errors import Error
from .neighbors import WeightedNeighbors, as_cutoff

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .files import Frame
    from .world import Start, World


class Network:
    """A network of a model: edges between its agents, each with a weight; an entry of ``networks`` of the class.

    ::

        networks = {"friends": gridlock.Network(), "follows": gridlock.Network(directed=True)}

    :param directed: whether an edge leads from an agent to another, and not back.

    :meth:`gridlock.Model.start` connects the agents, ``start.friends.connect_small_world(degree=6, rewiring=0.1)``, and
    :meth:`gridlock.Model.step` reads and changes the edges: see :class:`gridlock.WorldNetwork`.
    """

    def __init__(self, directed: bool = False, documentation: str = "") -> None:
        if not isinstance(directed, bool):
            raise Error(f"a network has directed={in_short(directed)}\n  hint: use True or False")
        self.directed = directed
        self.documentation = documentation

    def __repr__(self) -> str:
        return f"<gridlock.Network with {'directed' if self.directed else 'undirected'} edges>"


class Edges(NamedTuple):
    """The edges of a network in a :class:`gridlock.Frame`, sorted by their Ids."""

    ids: NDArray[np.uint64]  #: of the agents at both ends, the smaller Id first where edges have no direction; shape (E, 2)
    weights: NDArray[np.float64]  #: shape (E,)
    directed: bool  #: whether edges lead from the first agent to the second

    def __repr__(self) -> str:
        return named_in_short(self)


class WorldNetwork:
    """A network as a model sees and changes it, in its start and in a step: ``world.friends``.

    Rows are those of the columns of agents. Edges of the dead vanish with them; those of newborn agents take the rows that
    :meth:`gridlock.World.add` returns, and are there after the step. Everything else holds at once.
    """

    def __init__(self, seen: Start | World, name: str) -> None:
        self._seen = seen
        self._core = seen._core
        self._name = name

    def __repr__(self) -> str:
        return f"<gridlock.WorldNetwork {self._name}>"

    def __len__(self) -> int:
        return len(self.edges)

    @property
    def directed(self) -> bool:
        return self._seen._model.networks[self._name].directed

    @property
    def edges(self) -> NDArray[np.uint32]:
        """The rows at both ends of every edge, shape (E, 2), in the order of their Ids."""
        stored: Any = self._core.network_edges(self._name)
        rows: NDArray[np.uint32] = stored[0]
        rows.flags.writeable = False
        return rows

    @property
    def weights(self) -> NDArray[np.float64]:
        """The weight of every edge, shape (E,); 1 unless others are given. ``world.friends.weights = …`` takes a number or an array."""
        stored: Any = self._core.network_edges(self._name)
        weights: NDArray[np.float64] = stored[1]
        weights.flags.writeable = False
        return weights

    @weights.setter
    def weights(self, weights: ArrayLike) -> None:
        self._require_writable()
        self._core.set_weights(self._name, _weights(weights, len(self)))

    def neighbors(self, *, incoming: bool = False) -> WeightedNeighbors:
        """The neighbours of every agent on the network, each list in the order of the Ids, with the weights of the edges.

        In a directed network they are the agents that edges lead to; with ``incoming`` those that edges come from.
        ``world.friends.neighbors() | world.neighbors(0.1)`` are those on the network or in space, each once.
        """
        lists: Any = self._core.network_lists(self._name, bool(incoming))
        return WeightedNeighbors(*lists)

    def has(self, i: ArrayLike, j: ArrayLike) -> NDArray[np.bool_]:
        """Whether there is an edge from the agents of rows i to those of rows j."""
        found: Any = self._core.has_edges(self._name, _rows(i, j))
        there: NDArray[np.bool_] = found.view(np.bool_)
        return there

    def connect(self, i: ArrayLike, j: ArrayLike, weights: ArrayLike = 1.0) -> None:
        """Adds edges from the agents of rows i to those of rows j: ``connect(*world.pairs(0.1).T)``.

        :raises Error: for an edge that is there, from an agent to itself, or to an agent that is not there.
        """
        self._require_writable()
        rows = _rows(i, j)
        self._core.connect(self._name, rows, _weights(weights, len(rows)))

    def disconnect(self, i: ArrayLike, j: ArrayLike) -> None:
        """Removes the edges from the agents of rows i to those of rows j.

        :raises Error: for an edge that is not there.
        """
        self._require_writable()
        self._core.disconnect(self._name, _rows(i, j))

    def connect_within(self, cutoff: float) -> None:
        """Adds an edge between all agents nearer than the cutoff, around the edges of a periodic box; in both directions."""
        found: Any = self._core.pairs(as_cutoff(cutoff), (0, self._core.size()))
        self._connect_both_ways(self._seen._counted(found.T))

    def connect_at_random(self, *, probability: float | None = None, edges: int | None = None, purpose: int = 0) -> None:
        """Adds each possible edge with the same probability, or so many edges, all sets with the same probability.

        Random numbers are a function of the seed, the step, the network and the purpose alone: a second call in one step needs another
        purpose. (E. N. Gilbert, 1959, doi:10.1214/aoms/1177706098; P. Erdős and A. Rényi, 1959, Publicationes Mathematicae 6, 290.)
        """
        if (probability is None) == (edges is None):
            raise Error("random edges need either their probability or their number\n  hint: connect_at_random(probability=0.01)")
        if edges is None:
            chance = as_number(probability, "the probability of an edge", "use a number from 0 to 1", least=-1e-300)
            self._connect_rows(self._drawn("probability", chance, 0.0, purpose))
        else:
            count = as_count(edges, "the number of edges", "use a whole number from 0 on", least=0)
            self._connect_rows(self._drawn("edges", count, 0.0, purpose))

    def connect_small_world(self, degree: int, rewiring: float, *, purpose: int = 0) -> None:
        """Connects each agent to its ``degree`` nearest ones on a ring of all rows, and moves one end of each edge with the probability
        ``rewiring``; in both directions. (D. J. Watts and S. H. Strogatz, 1998, doi:10.1038/30918.)
        """
        count = as_count(degree, "the degree", "use an even number from 2 on")
        chance = as_number(rewiring, "the probability of rewiring", "use a number from 0 to 1", least=-1e-300)
        self._connect_both_ways(self._drawn("small world", count, chance, purpose))

    def connect_scale_free(self, edges_per_agent: int, *, purpose: int = 0) -> None:
        """Connects each agent, one after the other, to so many others, drawn with a probability proportional to their degrees; in both
        directions. (A.-L. Barabási and R. Albert, 1999, doi:10.1126/science.286.5439.509.)
        """
        count = as_count(edges_per_agent, "the number of edges per agent")
        self._connect_both_ways(self._drawn("scale free", count, 0.0, purpose))

    def connect_graph(self, graph: Any, *, rows: ArrayLike | None = None, weight: str = "weight") -> None:
        """Adds the edges of a graph of NetworkX.

        :param rows: the row of each node in the order of ``graph.nodes``; 0, 1, 2 … where left out.
        :param weight: the attribute of edges that has their weights, 1 where it is missing.
        """
        if not hasattr(graph, "nodes") or not hasattr(graph, "is_directed"):
            raise Error(f"{type(graph).__name__} is no graph\n  hint: give a graph of NetworkX, or connect(i, j)")
        nodes = list(graph.nodes)
        places = np.arange(len(nodes)) if rows is None else as_array(rows, "the rows of the nodes are", "use whole numbers", integers=True)
        if places.shape != (len(nodes),):
            raise Error(f"there are {places.size} rows for {len(nodes)} nodes\n  hint: give one for each node of graph.nodes")
        if graph.is_directed() and not self.directed:
            raise Error(f"the graph is directed, and the network {self._name} is not\n  hint: graph.to_undirected(), or Network(directed=True)")
        row_of = dict(zip(nodes, places.tolist()))
        edges = list(graph.edges(data=weight, default=1.0))
        pairs = np.array([(row_of[a], row_of[b]) for a, b, _ in edges], dtype=np.int64).reshape(-1, 2)
        weights = _weights([value for _, _, value in edges], len(edges))
        if self.directed and not graph.is_directed():
            self._connect_both_ways(pairs, weights)
        else:
            self._connect_rows(pairs, weights)

    def to_networkx(self) -> Any:
        """A ``networkx.Graph`` or ``DiGraph`` whose nodes are the rows of all agents, with the weights of the edges.

        :raises Error: where NetworkX is not installed.
        """
        return _graph(range(len(self._seen)), self.edges, self.weights, self.directed)

    def _drawn(self, kind: str, first: float, second: float, purpose: int) -> NDArray[np.uint32]:
        number = as_count(purpose, "the purpose", "use a whole number from 0 on", least=0)
        pairs: Any = self._core.random_pairs(self._name, kind, float(first), float(second), number)
        return pairs  # type: ignore[no-any-return]

    def _connect_rows(self, pairs: NDArray[Any], weights: ArrayLike = 1.0) -> None:
        self.connect(pairs[:, 0], pairs[:, 1], weights)

    def _connect_both_ways(self, pairs: NDArray[Any], weights: ArrayLike = 1.0) -> None:
        if self.directed:
            pairs = np.concatenate([pairs, pairs[:, ::-1]])
            weights = np.tile(weights, 2) if np.ndim(weights) else weights
        self._connect_rows(pairs, weights)

    def _require_writable(self) -> None:
        self._seen._require_writable("change a network")


def graph_of_frame(frame: Frame, network: str) -> Any:
    """The network of a frame for :meth:`gridlock.Frame.to_networkx`."""
    if network not in frame.networks:
        raise Error(f"the frame has no network {network!r}\n  hint: it has {', '.join(frame.networks) or 'none'}")
    edges = frame.networks[network]
    graph = _graph(frame.ids.tolist(), edges.ids, edges.weights, edges.directed)
    for name, values in frame.columns.items():
        for node, value in zip(frame.ids.tolist(), values.tolist()):
            graph.nodes[node][name] = value
    return graph


def _graph(nodes: Any, pairs: NDArray[Any], weights: NDArray[np.float64], directed: bool) -> Any:
    networkx = library("networkx", "networkx")
    graph = networkx.DiGraph() if directed else networkx.Graph()
    graph.add_nodes_from(nodes)
    graph.add_weighted_edges_from(zip(*pairs.T.tolist(), weights.tolist()))
    return graph


def _rows(i: ArrayLike, j: ArrayLike) -> NDArray[np.uint64]:
    """The rows at both ends of edges, shape (E, 2)."""
    hint = "use whole numbers from 0 on, or arrays of them of one length"
    ends = [np.atleast_1d(as_array(rows, "the rows of edges are", hint, integers=True)) for rows in (i, j)]
    shapes = {end.shape for end in ends if end.shape != (1,)}
    if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
        raise Error(f"the rows of edges have shapes {ends[0].shape} and {ends[1].shape}\n  hint: {hint}")
    rows = np.stack(np.broadcast_arrays(*ends), axis=1)
    if rows.size and rows.min() < 0:
        raise Error(f"an edge joins row {rows.min()}\n  hint: {hint}")
    return np.ascontiguousarray(rows, dtype=np.uint64)


def _weights(weights: ArrayLike, count: int) -> NDArray[np.float64]:
    hint = f"use a number or an array of shape ({count},)"
    array = as_array(weights, "the weights are", hint)
    return as_numbers(np.full(count, array) if array.ndim == 0 else array, "the weights", (count,), hint)
