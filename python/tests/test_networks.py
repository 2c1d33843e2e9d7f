"""Networks of models in Python: how they are drawn, what a step does with them, births and deaths, and where they are kept."""

import pickle

import numpy as np
import pytest

import gridlock

PERIODIC = {"width": 2.0, "height": 1.0, "edge": "periodic"}


@gridlock.register_model
class Friends(gridlock.Model):
    """Walkers that make and lose friends, are born as friends of a parent, and die."""

    name = "test_friends"
    columns = {"mood": float}
    networks = {"friends": gridlock.Network(), "follows": gridlock.Network(directed=True)}
    count = gridlock.Setting(200, "Agents.", least=1)
    birth = gridlock.Setting(0.02, "In a step.")

    def start(self, start):
        start.add(positions=start.anywhere(self.count), mood=start.uniform(self.count))
        start.friends.connect_small_world(4, 0.1)
        start.follows.connect_at_random(probability=0.01)

    def step(self, world):
        random = world.uniform(2)
        near = world.friends.neighbors()
        world.mood += 0.1 * (near | world.neighbors(0.05)).sum(world.mood) / 100 + 0.01 * world.follows.neighbors(incoming=True).weighted_sum(world.mood) / 100
        a, b = world.friends.edges[world.uniform_of_step(len(world.friends)) < 0.02].T
        world.friends.disconnect(a, b)
        i, j = world.pairs(0.02).T
        new = ~world.friends.has(i, j)
        world.friends.connect(i[new], j[new], 0.5)
        world.follows.weights = world.follows.weights * 0.99
        parents = np.flatnonzero(random[:, 0] < self.birth)
        born = world.add(positions=world.positions[parents])
        world.friends.connect(parents, born)
        world.follows.connect(born, parents, 2.0)
        world.remove(random[:, 1] < 0.02)
        world.move(0.02 * world.normal(2, purpose=1))

    def observe(self, world):
        return {"edges": len(world.friends), "degree": world.friends.neighbors().counts.mean()}


def friends(**settings):
    return gridlock.Simulation(model=Friends, box=PERIODIC, observe={"every": 5}, **settings)


class One(gridlock.Model):
    """One network, and what a test lets its start and step do."""

    name = "test_network"
    columns = {"got": float}
    networks = {"net": gridlock.Network()}
    fields = {"grass": gridlock.Field(2)}
    count = gridlock.Setting(5, "Agents.", least=0)

    def start(self, start):
        start.add(positions=start.anywhere(self.count))

    def step(self, world):
        pass


def simulation(start=None, step=None, box=PERIODIC, count=5, **body):
    def first(self, given):
        One.start(self, given)
        if start is not None:
            start(given)

    made = {"start": first, "step": lambda self, world: None if step is None else step(world)}
    return gridlock.Simulation(model=type("OneNetwork", (One,), {**made, **body})(count=count), box=box)


def edges_of(made, name="net"):
    return made.frame.networks[name].ids.tolist()


def after(start, step, **others):
    made = simulation(start, step, **others)
    made.run(steps=1)
    return made


def drawn(count, build, seed=1, **body):
    """The network of a start as rows of pairs, shape (E, 2)."""
    made = gridlock.Simulation(model=type("Drawn", (One,), {"start": lambda self, given: (One.start(self, given), build(given.net))[0], **body})(count=count),
                               run={"seed": seed})
    return made.frame.networks["net"].ids.astype(np.int64)


def degrees(edges, count):
    return np.bincount(edges.ravel(), minlength=count)


def test_agents_know_their_neighbours_on_the_network_with_the_weights_of_edges():
    def step(world):
        lists = world.net.neighbors()
        order = np.argsort(world.ids)
        assert sorted(lists.of(order[1])) == sorted(order[[0, 2]]) and lists.counts[order].tolist() == [2, 2, 2, 1, 1]
        world.got = lists.weighted_sum(world.ids.astype(float))
        np.testing.assert_allclose(lists.sum(np.ones(5)), lists.counts)
        assert lists.mean(world.ids.astype(float))[order[3]] == 4.0
        assert world.ids[world.rows_of([[0, 4], [2, 1]])].tolist() == [[0, 4], [2, 1]]
        assert pickle.loads(pickle.dumps(lists)).weights.tolist() == lists.weights.tolist()

    made = after(lambda start: start.net.connect([0, 1, 0, 4], [1, 2, 2, 3], [0.5, 2.0, 1.0, 3.0]), step)
    assert made.agents.got[np.argsort(made.agents.ids)].tolist() == [0.5 * 1 + 2.0, 2.0 * 2 + 0.0, 2.0 * 1 + 0.0, 12.0, 9.0]


def test_a_directed_network_tells_edges_that_leave_from_those_that_arrive():
    def step(world):
        row = world.rows_of([0, 1, 2])
        assert world.net.neighbors().counts[row].tolist() == [2, 1, 0]
        assert world.net.neighbors(incoming=True).counts[row].tolist() == [1, 1, 1]
        assert world.net.has(row[[0, 1, 2]], row[[1, 0, 0]]).tolist() == [True, True, False]

    after(lambda start: start.net.connect([0, 1, 0], [1, 0, 2]), step, networks={"net": gridlock.Network(directed=True)})


def test_neighbours_in_space_and_on_the_network_unite_to_those_in_either():
    def step(world):
        near, known = world.neighbors(0.3), world.net.neighbors()
        both = near | known
        for row in range(len(world)):
            assert both.of(row).tolist() == sorted({*near.of(row).tolist(), *known.of(row).tolist()})
        assert both.counts.sum() > max(near.counts.sum(), known.counts.sum())

    after(lambda start: start.net.connect_at_random(probability=0.1), step, count=40)


def test_a_network_by_distance_has_the_pairs_within_it_around_the_edges():
    def build(start):
        start.net.connect_within(0.25)
        assert {tuple(sorted(pair)) for pair in start.net.edges.tolist()} == {
            tuple(sorted(pair)) for pair in gridlock.pairs(places, 0.25, gridlock.Box(2.0, 1.0)).tolist()}

    places = np.random.default_rng(1).random((60, 2)) * (2.0, 1.0)

    def start(self, given):
        given.add(positions=places)
        build(given)

    made = gridlock.Simulation(model=type("Near", (One,), {"start": start}), box=PERIODIC)
    assert len(edges_of(made)) > 60


@pytest.mark.parametrize("probability", [0.002, 0.7])
def test_random_graphs_have_binomial_degrees(probability):
    stats = pytest.importorskip("scipy.stats")
    count = 3000 if probability < 0.5 else 400
    edges = drawn(count, lambda net: net.connect_at_random(probability=probability))
    pairs = count * (count - 1) / 2
    assert abs(len(edges) - probability * pairs) < 4 * np.sqrt(pairs * probability * (1 - probability))
    law = stats.binom(count - 1, probability)
    bounds = np.unique(law.ppf(np.linspace(0.02, 0.98, 15)))
    seen = np.histogram(degrees(edges, count), [-1, *(bounds + 0.5), count])[0]
    expected = count * np.diff(law.cdf([-1, *bounds, count]))
    assert stats.chisquare(seen, expected * seen.sum() / expected.sum()).pvalue > 1e-3


def test_random_graphs_with_a_number_of_edges_have_it_and_take_every_pair_alike():
    assert len(drawn(300, lambda net: net.connect_at_random(edges=44_850))) == 44_850
    assert len(drawn(300, lambda net: net.connect_at_random(probability=1.0))) == 44_850
    assert len(drawn(300, lambda net: net.connect_at_random(probability=0.0))) == 0
    both = {"networks": {"net": gridlock.Network(directed=True)}}
    assert len(drawn(30, lambda net: net.connect_at_random(edges=870), **both)) == 870
    seen = np.zeros((8, 8))
    for seed in range(200):
        edges = drawn(8, lambda net: net.connect_at_random(edges=7), seed)
        np.add.at(seen, tuple(edges.T), 1)
    times = seen[np.triu_indices(8, 1)]
    assert times.sum() == 1400 and np.sum((times - 50) ** 2 / (50 * 0.75)) < 58  # χ² of 27 degrees of freedom: 58 in 1 of 2,000


def test_small_worlds_begin_as_ring_lattices_and_keep_their_edges_when_rewired():
    networkx = pytest.importorskip("networkx")
    ring = networkx.Graph(drawn(100, lambda net: net.connect_small_world(6, 0.0)).tolist())
    assert set(dict(ring.degree).values()) == {6}
    assert networkx.average_clustering(ring) == pytest.approx(3 * (6 - 2) / (4 * (6 - 1)), abs=1e-12)
    edges = drawn(4000, lambda net: net.connect_small_world(6, 0.1))
    assert len(np.unique(edges, axis=0)) == 12_000
    # 3 (k − 2) / (4 (k − 1)) × (1 − p)³ for neighbours of a mean degree (A. Barrat & M. Weigt, 2000, doi:10.1007/s100510050067), here over
    # k (k − 1) of degrees with the variance (1 − p) p k/2 + p k/2. The standard deviation is that of 20 graphs of NetworkX.
    variance = 0.9 * 0.1 * 3 + 0.1 * 3
    assert networkx.transitivity(networkx.Graph(edges.tolist())) == pytest.approx(0.6 * 0.9**3 * 30 / (30 + variance), abs=4 * 0.0046)
    moved = np.minimum((edges[:, 1] - edges[:, 0]) % 4000, (edges[:, 0] - edges[:, 1]) % 4000) > 3
    assert abs(moved.mean() - 0.1) < 4 * np.sqrt(0.09 / 12_000)
    # The node that keeps an edge keeps half of its degree.
    assert degrees(edges, 4000).min() >= 3


def test_scale_free_networks_have_the_exact_distribution_of_degrees():
    count, m = 20_000, 3
    edges = drawn(count, lambda net: net.connect_scale_free(m))
    assert len(np.unique(edges, axis=0)) == m * (count - m)
    found = degrees(edges, count)
    # P(degree ≥ k) = m (m + 1) / (k (k + 1)): S. N. Dorogovtsev et al., 2000, doi:10.1103/PhysRevLett.85.4633.
    for k in (4, 5, 8, 15, 30, 60):
        share = m * (m + 1) / (k * (k + 1))
        assert abs(np.mean(found >= k) - share) < 4 * np.sqrt(share / count), k


def test_graphs_are_a_function_of_the_seed_the_network_and_the_purpose():
    def build(purpose):
        return lambda net: net.connect_at_random(edges=40, purpose=purpose)

    first = drawn(50, build(0)).tolist()
    assert first == drawn(50, build(0)).tolist()
    assert first != drawn(50, build(1)).tolist() and first != drawn(50, build(0), seed=2).tolist()


def test_networkx_graphs_go_in_and_come_out():
    networkx = pytest.importorskip("networkx")
    graph = networkx.karate_club_graph()

    def start(given):
        given.net.connect_graph(graph)
        assert networkx.utils.graphs_equal(networkx.Graph(graph.edges(data=True)), networkx.Graph(given.net.to_networkx().edges(data=True)))

    made = simulation(start, count=40)
    out = made.frame.to_networkx("net")
    assert len(out) == 40 and {*map(frozenset, out.edges)} == {*map(frozenset, graph.edges)}
    assert out.nodes[3]["x"] == made.frame.x[3] and out.edges[0, 1]["weight"] == graph.edges[0, 1]["weight"]
    words = networkx.DiGraph([("a", "b"), ("b", "c"), ("c", "b")])
    both = simulation(lambda given: given.net.connect_graph(words, rows=[4, 0, 2]), networks={"net": gridlock.Network(directed=True)})
    assert edges_of(both) == [[0, 2], [2, 0], [4, 0]]
    with pytest.raises(gridlock.Error, match="the graph is directed"):
        simulation(lambda given: given.net.connect_graph(words))


def test_edges_of_the_dead_vanish_and_newborn_agents_can_be_connected():
    def step(world):
        row = world.rows_of([0, 1, 2, 3, 4])
        born = world.add(x=[0.5, 0.6, 0.7], y=0.5)
        world.net.connect(born[:2], row[[0, 1]], [5.0, 6.0])
        world.net.connect(born[2], born[1], 7.0)
        world.remove(row[[1]])
        assert len(world.net) == 4  # those of newborn agents come after the step

    made = after(lambda start: start.net.connect([0, 1, 2, 3], [1, 2, 3, 4]), step)
    frame = made.frame
    (first, second, third), net = [int(frame.ids[np.flatnonzero(frame.x == x)[0]]) for x in (0.5, 0.6, 0.7)], frame.networks["net"]
    assert {frozenset(pair): weight for pair, weight in zip(net.ids.tolist(), net.weights)} == {
        frozenset({2, 3}): 1.0, frozenset({3, 4}): 1.0, frozenset({0, first}): 5.0, frozenset({second, third}): 7.0}


def test_a_step_that_raises_leaves_networks_as_they_were():
    def step(world):
        world.net.disconnect(*world.net.edges[0])
        world.net.weights = 3.0
        raise ValueError("enough")

    made = simulation(lambda start: start.net.connect([0, 1], [1, 2]), step)
    with pytest.raises(gridlock.RunFailure, match="enough"):
        made.run(steps=1)
    assert edges_of(made) == [[0, 1], [1, 2]] and made.frame.networks["net"].weights.tolist() == [1.0, 1.0]


def test_networks_give_the_same_bits_on_any_threads_and_count_in_the_hash():
    runs = [friends(engine={"threads": threads}) for threads in (1, 3)]
    for run in runs:
        run.run(steps=70)
    assert runs[0].state_hash == runs[1].state_hash

    def with_weight(weight):
        return simulation(lambda start: start.net.connect(0, 1, weight)).state_hash

    assert with_weight(1.0) == with_weight(1.0) != with_weight(2.0)
    assert simulation(lambda start: start.net.connect([0, 1], [1, 2])).state_hash == simulation(lambda start: start.net.connect([2, 1], [1, 0])).state_hash


def test_a_run_keeps_its_networks_and_goes_on_with_the_same_bits(tmp_path):
    settings = {"model.kind": "test_friends", "box": PERIODIC, "observe.every": 10, "trajectory.every": 25}
    gridlock.run({**settings, "run.steps": 100}, tmp_path / "whole")
    gridlock.run({**settings, "run.steps": 60}, tmp_path / "parts")
    gridlock.open(tmp_path / "parts").resume(steps=100)
    whole, parts = gridlock.open(tmp_path / "whole"), gridlock.open(tmp_path / "parts")
    assert whole.summary["state_hash"] == parts.summary["state_hash"]
    assert whole.series["edges"][-1] == len(whole.final.networks["friends"].ids)
    for frame in whole.trajectory:
        assert list(frame.networks) == ["follows", "friends"] and frame.networks["follows"].directed
        for edges in frame.networks.values():
            assert np.isin(edges.ids, frame.ids).all() and len(edges.ids) == len(edges.weights)
    for name, edges in whole.final.networks.items():
        assert (edges.ids == whole.trajectory[-1].networks[name].ids).all() and (edges.weights == parts.final.networks[name].weights).all()
    assert len({len(frame.networks["friends"].ids) for frame in whole.trajectory}) > 2
    h5py = pytest.importorskip("h5py")
    with h5py.File(whole.path / "trajectory.h5") as file:
        group, edges = file["connectivity/networks/friends"], whole.final.networks["friends"]
        assert (group["value"][-1, : len(edges.ids)] == edges.ids).all() and (group["value"][-1, len(edges.ids) :] == 2**64 - 1).all()
        assert group.attrs["directed"] == 0 and file[group.attrs["particles_group"]].name == "/particles/disks"
        assert group["step"][:].tolist() == [0, 25, 50, 75, 100]
    assert gridlock.verify(whole.path).is_verified


def test_verify_finds_another_edge_in_the_last_networks(tmp_path):
    for name, birth in (("one", 0.02), ("other", 0.03)):
        gridlock.run({"model.kind": "test_friends", "box": PERIODIC, "run.steps": 20, "test_friends.birth": birth}, tmp_path / name)
    (tmp_path / "other/final_networks.h5").replace(tmp_path / "one/final_networks.h5")
    found = gridlock.verify(tmp_path / "one")
    assert not found.is_verified and "final_networks.h5 has an edge of agents" in found.text


def test_a_turn_takes_the_neighbours_that_its_model_names():
    pytest.importorskip("numba")

    class Rumour(gridlock.Model):
        name = "test_rumour_on_network"
        columns = {"knows": np.uint32}
        networks = {"friends": gridlock.Network()}

        def start(self, start):
            start.add(positions=start.anywhere(9), knows=np.arange(9) == 0)
            start.friends.connect(np.arange(8), np.arange(1, 9))

        def neighbors(self, world):
            return world.friends.neighbors()

        @staticmethod
        def turn(row, neighbors, separations, now, next, settings, random, events):
            for k in neighbors:
                if now.knows[k] == 1:
                    next.knows[row] = 1

    made = gridlock.Simulation(model=Rumour, box=PERIODIC)
    made.run(steps=5)
    assert made.agents.knows[np.argsort(made.agents.ids)].tolist() == [1] * 6 + [0] * 3


def test_voters_agree_on_an_opinion_with_the_probability_of_its_share_weighted_by_degrees():
    """K. Suchecki, V. M. Eguíluz & M. San Miguel, 2005, doi:10.1209/epl/i2004-10329-8: Σ degree × opinion is a martingale."""
    networkx = pytest.importorskip("networkx")
    one = networkx.Graph([(0, k) for k in range(1, 6)] + [(1, 2), (3, 4)])  # a hub, and two triangles on it
    copies = 1500
    graph = networkx.disjoint_union_all([one] * copies)

    class Voters(gridlock.Model):
        name = "test_voters"
        columns = {"opinion": np.uint32}
        networks = {"friends": gridlock.Network()}

        def start(self, start):
            start.add(positions=start.anywhere(6 * copies), opinion=np.arange(6 * copies) % 6 == 0)
            start.friends.connect_graph(graph)

        def step(self, world):
            world.opinion = world.opinion[world.friends.neighbors().pick(world.uniform())]

    made = gridlock.Simulation(model=Voters)
    made.run(steps=400)
    opinions = made.agents.opinion[np.argsort(made.agents.ids)].reshape(copies, 6)
    assert (opinions == opinions[:, :1]).all()
    share = 5 / 14
    assert abs(opinions[:, 0].mean() - share) < 4 * np.sqrt(share * (1 - share) / copies)


def connect(*arguments):
    return lambda start: start.net.connect(*arguments)


REFUSED = {
    "an agent that is not there": (connect(0, 5), "there is no agent in row 5 among 5"),
    "an edge to itself": (connect([0, 2], [1, 2]), "agent 2 has an edge to itself in the network net"),
    "an edge twice": (connect([0, 1], [1, 0]), "an edge is there twice in the network net: agents 0 and 1"),
    "a weight of nan": (connect([0], [1], [np.nan]), "the weights have the value nan at (0,)"),
    "weights of another length": (connect([0, 1], [1, 2], [1.0, 2.0, 3.0]), "the weights have shape (3,)"),
    "rows of two lengths": (connect([0, 1], [1, 2, 3]), "the rows of edges have shapes (2,) and (3,)"),
    "a row below 0": (connect(0, -1), "an edge joins row -1"),
    "half a row": (connect(0.5, 1), "the rows of edges are no array of whole numbers"),
    "an edge that is not there": (lambda start: start.net.disconnect(0, 1), "there is no such edge in the network net: agents 0 and 1"),
    "as many neighbours as agents": (lambda start: start.net.connect_small_world(6, 0.1), "each of 5 agents of a small world is to have 6 neighbours"),
    "odd numbers of neighbours": (lambda start: start.net.connect_small_world(3, 0.1), "is to have 3 neighbours"),
    "a probability above 1": (lambda start: start.net.connect_at_random(probability=1.5), "the probability of an edge is 1.5"),
    "neither probability nor number": (lambda start: start.net.connect_at_random(), "random edges need either"),
    "more edges than pairs": (lambda start: start.net.connect_at_random(edges=11), "a network of 5 agents is to have 11 edges"),
    "more edges than agents": (lambda start: start.net.connect_scale_free(5), "each of 5 agents of a scale-free network is to come with 5 edges"),
    "values": (lambda start: setattr(start, "net", 1.0), "net is a network, which takes no values"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_start_is_refused_for(case):
    start, words = REFUSED[case]
    with pytest.raises(gridlock.Error) as error:
        simulation(start)
    assert words in str(error.value)


def test_a_network_beyond_memory_is_refused():
    with pytest.raises(gridlock.Error, match=r"about 2e\+09 edges"):
        simulation(lambda start: start.net.connect_at_random(probability=1.0), count=63_246)


IN_A_STEP = {
    "newborn agents that are not there": (lambda world: (world.add(x=0.5, y=0.5), world.net.connect(0, 6)), "row 6 among 5 and 1 newborn ones"),
    "two edges of one newborn agent to the same": (lambda world: (world.add(x=0.5, y=0.5), world.net.connect([0, 0], [5, 5])), "an edge is there twice"),
    "an edge that a newborn agent has": (lambda world: (world.add(x=0.5, y=0.5), world.net.connect(0, 5), world.net.connect(5, 0)), "an edge is there twice"),
    "a newborn agent that is to lose edges": (lambda world: (world.add(x=0.5, y=0.5), world.net.disconnect(0, 5)), "those of newborn agents can be connected only"),
    "weights for other edges": (lambda world: setattr(world.net, "weights", [1.0, 2.0]), "the weights have shape (2,)"),
    "an infinite weight": (lambda world: setattr(world.net, "weights", np.inf), "the weights have the value inf"),
    "the Id of nobody": (lambda world: world.rows_of([3, 99]), "no agent with the Id 99 lives"),
    "a name that is none": (lambda world: world.nets, "there is no column 'nets'; there are x, y, got, grass, net"),
}


@pytest.mark.parametrize("case", IN_A_STEP)
def test_a_step_is_refused_for(case):
    step, words = IN_A_STEP[case]
    with pytest.raises(gridlock.RunFailure) as error:
        after(connect(0, 1), step)
    assert words in str(error.value)


def test_an_observation_cannot_change_a_network():
    with pytest.raises(gridlock.Error, match="an observation cannot change a network"):
        simulation(observe=lambda self, world: {"none": world.net.connect(0, 1)})


WRONG = {
    "no network": ({"net": 4}, "the network net of the model OneNetwork is 4"),
    "the name of a column": ({"got": gridlock.Network()}, "has a network 'got', the name of something else"),
    "the name of a field": ({"grass": gridlock.Network()}, "has a network 'grass', the name of something else"),
    "the name of a method": ({"move": gridlock.Network()}, "has a network 'move', the name of something else"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_model_is_refused_for(case):
    networks, words = WRONG[case]
    with pytest.raises(gridlock.Error) as error:
        simulation(networks=networks)
    assert words in str(error.value)


def test_a_network_without_agents_is_told():
    with pytest.warns(UserWarning, match="has no agents"):
        simulation(count=0)
    with pytest.raises(gridlock.Error, match="directed=1"):
        gridlock.Network(directed=1)
