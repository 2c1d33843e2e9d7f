"""The models of gridlock.library, beside published and exact numbers, and beside their rules in plain Python."""

import math
import random
import shutil
import subprocess
import sys

import numpy as np
import pytest

import gridlock
import gridlock.library
from gridlock.library import SIR, Ants, Boids, Flock, ForestFire, RandomOrganization, Schelling, SIRNetwork, Sugarscape, Voter, WolfSheep

WALLS = {"box.edge": "wall"}
PERIODIC = {"box.edge": "periodic"}


def ends(settings, names, *, steps, seeds, **more):
    """The last values of runs of several seeds: an array for each name."""
    made = gridlock.experiment({**settings, "observe.structure_every": 0}, steps=steps, seeds=seeds, processes=1, **more)
    return [made.table[name].astype(float) for name in names]


def in_both(model, kind, **values):
    """Settings of a model in Python and of the same model in C++."""
    return {"model": model(**values), **WALLS}, {"model.kind": kind, kind: values, **WALLS}


def require_mean(values, expected, *, within=3.5):
    """The mean of independent values is an exact number, but for its standard error."""
    error = np.std(values, ddof=1) / np.sqrt(len(values))
    assert error > 0 and abs(np.mean(values) - expected) < within * error, (np.mean(values), error, expected)


def require_same_means(ours, theirs):
    """Two samples of independent values have one mean, but for the standard error of the difference."""
    error = math.sqrt(np.var(ours, ddof=1) / len(ours) + np.var(theirs, ddof=1) / len(theirs))
    assert error > 0 and abs(np.mean(ours) - np.mean(theirs)) < 3.5 * error, (np.mean(ours), np.mean(theirs), error)


PERCOLATION_THRESHOLD = 0.59274605  # Newman & Ziff 2000, doi:10.1103/PhysRevLett.85.4104


@pytest.mark.parametrize("neighbors, density, sign", [("four", PERCOLATION_THRESHOLD, 1), ("eight", 1 - PERCOLATION_THRESHOLD, -1)])
def test_half_of_all_forests_burn_through_at_the_threshold_of_percolation(neighbors, density, sign):
    side = 32
    (crossed,) = ends({"model": ForestFire(side=side, density=density, neighbors=neighbors)}, ["crossed"], steps=5000, seeds=160,
                      until="burning == 0", every=16)
    # Ziff 1992, doi:10.1103/PhysRevLett.69.2670: 1/2 + 0.319/side; a forest is crossed by eight neighbours where the bare cells are not by four.
    require_mean(crossed, 0.5 + sign * 0.319 / side)


def test_a_fire_burns_what_is_joined_to_the_left_side():
    fire = gridlock.Simulation(model=ForestFire(side=60, density=0.6), box={"width": 2.0, "height": 1.0}, observe={"every": 1})
    forest = fire.frame.fields["forest"] > 0
    gridlock.run_until(fire, "burning == 0", steps=4000)
    label = pytest.importorskip("scipy.ndimage").label(forest)[0]
    joined = forest & np.isin(label, np.unique(label[:, 0][forest[:, 0]]))
    assert forest.shape == (30, 60) and np.array_equal(fire.frame.fields["forest"] == 3, joined)


def test_a_forest_burns_tree_by_tree_as_in_the_public_comparison():
    side = 30
    fire = gridlock.Simulation(model=ForestFire(side=side, density=0.7), box={"edge": "wall"})
    forest = fire.frame.fields["forest"].tolist()
    burning = [(row, 0) for row in range(side) if forest[row][0]]
    assert burning and all(forest[row][0] == 2 for row, _ in burning)
    for _ in range(side):
        fire.run(steps=1)
        before, burning = burning, []
        for row, column in before:
            for across, along in ((row - 1, column), (row + 1, column), (row, column - 1), (row, column + 1)):
                if 0 <= across < side and 0 <= along < side and forest[across][along] == 1:
                    forest[across][along] = 2
                    burning.append((across, along))
            forest[row][column] = 3
        assert fire.frame.fields["forest"].tolist() == forest


def test_agents_of_schelling_start_as_happy_as_chance_has_it():
    side, count, wanted = 40, 1000, 3
    cells, like = side**2 - 1, count // 2 - 1

    def is_happy(neighbors):
        return 1 - sum(math.comb(like, k) * math.comb(cells - like, neighbors - k) for k in range(wanted)) / math.comb(cells, neighbors)

    inner, rim = (side - 2) ** 2, 4 * (side - 2)
    for city in in_both(Schelling, "segregation", side=side, count=count, wanted=wanted):
        require_mean(ends(city, ["happy"], steps=0, seeds=40)[0], (inner * is_happy(8) + rim * is_happy(5) + 4 * is_happy(3)) / side**2)


def test_agents_that_nothing_satisfies_stay_mixed():
    (share,) = ends({"model": Schelling(side=12, count=100, wanted=9), **WALLS}, ["like_share"], steps=6, seeds=60)
    require_mean(share, 49 / 99)


def schelling_in_turns(side, count, radius, wanted, steps, seed):
    """The rules of the public comparison, agent by agent; returns the share of like neighbours and the moves."""
    draw = random.Random(seed)
    cells = [(x, y) for x in range(side) for y in range(side)]
    draw.shuffle(cells)
    home = {cell: (0 if n < count / 2 else 1) for n, cell in enumerate(cells[:count])}
    places, vacant, moves = cells[:count], cells[count:], 0

    def around(x, y):
        near = [(x + i, y + j) for i in range(-radius, radius + 1) for j in range(-radius, radius + 1) if (i, j) != (0, 0)]
        return [home[cell] for cell in near if cell in home]

    for _ in range(steps):
        for agent in draw.sample(range(count), count):
            x, y = places[agent]
            if around(x, y).count(home[x, y]) < wanted:
                k = draw.randrange(len(vacant))
                home[vacant[k]] = home.pop((x, y))
                places[agent], vacant[k] = vacant[k], (x, y)
                moves += 1
    shares = [around(*cell).count(group) / len(around(*cell)) for cell, group in home.items() if around(*cell)]
    return sum(shares) / len(shares), moves


@pytest.mark.parametrize("radius, wanted", [(1, 3), (2, 8)])
def test_schelling_is_that_of_the_public_comparison(radius, wanted):
    side, count, steps = 12, 100, 6
    theirs = np.array([schelling_in_turns(side, count, radius, wanted, steps, seed) for seed in range(25)]).T
    for city in in_both(Schelling, "segregation", side=side, count=count, radius=radius, wanted=wanted):
        for one, other in zip(ends(city, ["like_share", "moves"], steps=steps, seeds=50), theirs):
            require_same_means(one, other)


def test_agents_who_want_three_of_eight_end_among_their_own():
    settings = {"model": Schelling, **WALLS}
    made = gridlock.experiment(settings, steps=200, seeds=3, until="happy == 1", processes=1)
    assert made.table["ended"].all() and made.table["like_share"].min() > 0.8


def test_schelling_has_one_agent_in_a_cell_and_keeps_its_map():
    city = gridlock.Simulation(model=Schelling(side=20, count=120), box={"width": 2.0, "height": 1.0, "edge": "wall"})
    city.run(steps=5)
    frame = city.frame
    homes = frame.fields["homes"]
    rows, columns = (frame.positions[:, 1] * 10).astype(int), (frame.positions[:, 0] * 10).astype(int)
    mapped = np.zeros_like(homes)
    mapped[rows, columns] = frame.group + 1
    assert homes.shape == (10, 20) and np.array_equal(mapped, homes) and np.count_nonzero(homes) == 120


def sugarscape_in_turns(capacity, count, vision, growback, endowment, lifespan, steps, seed):
    """The rules of the book on a torus, agent by agent, with new agents for the dead where they have a lifespan; the number of agents, and
    the Gini coefficient of their wealth."""
    draw = random.Random(seed)
    side = len(capacity)
    sugar = {(x, y): capacity[y][x] for x in range(side) for y in range(side)}

    def newcomer(cell):
        return {"cell": cell, "vision": draw.randint(1, vision), "use": draw.randint(1, 4), "wealth": draw.randint(*endowment), "age": 0,
                "lifespan": draw.randint(*lifespan) if lifespan else 10**9}

    agents = [newcomer(cell) for cell in draw.sample(list(sugar), count)]
    for _ in range(steps):
        sugar = {(x, y): min(there + growback, capacity[y][x]) for (x, y), there in sugar.items()}
        dead = []
        for agent in draw.sample(agents, len(agents)):
            x, y = agent["cell"]
            ways = [(0, (x, y))] + [(far, ((x + i * far) % side, (y + j * far) % side))
                                    for far in range(1, agent["vision"] + 1) for i, j in ((1, 0), (-1, 0), (0, 1), (0, -1))]
            taken = {one["cell"] for one in agents if one is not agent}
            best = min((-sugar[cell], far) for far, cell in ways if cell not in taken)
            agent["cell"] = draw.choice([cell for far, cell in ways if cell not in taken and (-sugar[cell], far) == best])
            agent["wealth"] += sugar[agent["cell"]] - agent["use"]
            sugar[agent["cell"]] = 0
            agent["age"] += 1
            if agent["wealth"] <= 0 or agent["age"] > agent["lifespan"]:
                dead.append(agent)
                agents.remove(agent)
        if lifespan:
            empty = list(sugar.keys() - {one["cell"] for one in agents})
            agents += [newcomer(cell) for cell in draw.sample(empty, len(dead))]
    wealth = np.array([one["wealth"] for one in agents])
    return len(agents), np.abs(wealth[:, None] - wealth).sum() / (2 * len(wealth)**2 * wealth.mean())


@pytest.mark.parametrize("lifespan", [None, (3, 9)])
def test_sugarscape_is_that_of_the_book_agent_by_agent(lifespan):
    side, count, vision, steps, endowment = 8, 24, 3, 10, (2, 6)
    model = Sugarscape(side=side, count=count, vision=vision, min_endowment=endowment[0], endowment=endowment[1],
                       replacement=lifespan is not None, min_lifespan=(lifespan or (1, 1))[0], lifespan=(lifespan or (1, 1))[1])
    ours = ends({"model": model, **PERIODIC}, ["agents", "gini"], steps=steps, seeds=30)
    capacity = model.capacity(side, side).tolist()
    theirs = np.array([sugarscape_in_turns(capacity, count, vision, 1, endowment, lifespan, steps, seed) for seed in range(20)]).T
    if lifespan is None:
        require_same_means(ours[0], theirs[0])
    else:
        assert (ours[0] == count).all()
    require_same_means(ours[1], theirs[1])


def test_the_endowments_of_sugarscape_are_as_unequal_as_chance_has_it():
    count, least, most = 400, 5, 25
    values = most - least + 1
    (shares,) = ends({"model": Sugarscape(count=count)}, ["gini"], steps=0, seeds=40)
    require_mean(shares, (1 - 1 / count) * (values**2 - 1) / (3 * values * (least + most)))


def test_nobody_starves_in_sugarscape_whose_cell_holds_enough_and_grows_back_at_once():
    scape = gridlock.Simulation(model=Sugarscape(growback=4.0, count=1000), box={"edge": "periodic"})
    first = scape.frame
    held = Sugarscape().capacity(50, 50)[tuple((first.positions[:, ::-1] * 50).astype(int).T)]
    scape.run(steps=60)
    fed = first.ids[held >= first.metabolism]
    assert 300 < len(fed) < len(scape.agents) < 1000 and np.isin(fed, scape.frame.ids).all()


@pytest.mark.parametrize("edge", ["periodic", "wall"])
def test_sugar_is_where_it_was_or_eaten_and_no_two_agents_share_a_cell(edge):
    scape = gridlock.Simulation(model=Sugarscape(growback=0.0), box={"edge": edge, "width": 2.0, "height": 1.0})
    for _ in range(5):
        before = scape.frame
        scape.run(steps=1)
        after = scape.frame
        living = np.isin(before.ids, after.ids)
        cells = (after.positions * 25).astype(int)
        assert after.fields["sugar"].shape == (25, 50) and len(np.unique(cells, axis=0)) == len(cells)
        # What the dead have found, and more, they have used up.
        eaten = before.fields["sugar"].sum() - after.fields["sugar"].sum()
        gained = (after.wealth - before.wealth[living] + before.metabolism[living]).sum()
        assert gained <= eaten <= gained + 4 * np.count_nonzero(~living)


def test_wolves_without_sheep_live_on_what_they_have():
    steps, gain = 10, 13
    (wolves,) = ends({"model": WolfSheep(sheep=0, wolves=200, wolf_birth=0.0), **WALLS}, ["wolves"], steps=steps, seeds=40)
    require_mean(wolves, 200 * (2 * gain - steps) / (2 * gain))


def test_a_flock_without_wolves_settles_where_its_food_grows():
    regrowth, gain = 20, 5.0
    meadow = gridlock.Simulation(model=WolfSheep(wolves=0, regrowth=regrowth, sheep_gain=gain), box={"edge": "periodic"}, observe={"every": 1})
    meadow.run(steps=300)
    seen, counts = meadow.series, meadow.counts
    walked = seen["sheep"][:-1].sum()
    # The dead have less than 0 energy, and at least -1.
    lost = seen["energy_of_sheep"][-1] - seen["energy_of_sheep"][0] - gain * counts["meals_of_sheep"] + walked
    assert 0.0 <= lost < counts["starved_sheep"]
    # Little 1961, doi:10.1287/opre.9.3.383: as many cells are bare as meals in a step, times the steps until the grass is grown.
    bare = 625 * (1 - seen["grass"])
    assert abs(bare[1:].sum() - (regrowth - 1) * counts["meals_of_sheep"]) < 625 * regrowth / 2


def wolf_sheep_in_turns(side, sheep, wolves, regrowth, births, steps, seed):
    """The rules of the public comparison, animal by animal; returns the numbers of sheep and wolves, and the grown cells."""
    draw = random.Random(seed)
    gains = (5.0, 13.0)
    herds = [[[draw.randrange(side), draw.randrange(side), float(draw.randrange(int(2 * gain)))] for _ in range(count)]
             for gain, count in zip(gains, (sheep, wolves))]
    bare = {(x, y): 0 if draw.random() < 0.5 else 1 + draw.randrange(regrowth) for x in range(side) for y in range(side)}
    hops = [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1) if (x, y) != (0, 0)]
    for _ in range(steps):
        for kind in (0, 1):
            for animal in draw.sample(herds[kind], len(herds[kind])):
                x, y = draw.choice(hops)
                animal[0], animal[1] = min(max(animal[0] + x, 0), side - 1), min(max(animal[1] + y, 0), side - 1)
                animal[2] -= 1
                cell = (animal[0], animal[1])
                if kind == 0 and bare[cell] == 0:
                    animal[2] += gains[0]
                    bare[cell] = regrowth
                prey = [other for other in herds[0] if (other[0], other[1]) == cell] if kind == 1 else []
                if prey:
                    eaten = draw.choice(prey)
                    herds[0] = [other for other in herds[0] if other is not eaten]
                    animal[2] += gains[1]
                if animal[2] < 0:
                    herds[kind] = [other for other in herds[kind] if other is not animal]
                elif draw.random() < births[kind]:
                    animal[2] /= 2
                    herds[kind].append(list(animal))
        bare = {cell: max(left - 1, 0) for cell, left in bare.items()}
    return len(herds[0]), len(herds[1]), sum(left == 0 for left in bare.values()) / side**2


def test_wolves_and_sheep_are_those_of_the_public_comparison():
    side, sheep, wolves, regrowth, births, steps = 9, 40, 15, 6, (0.4, 0.2), 12
    theirs = np.array([wolf_sheep_in_turns(side, sheep, wolves, regrowth, births, steps, seed) for seed in range(80)]).T
    values = dict(side=side, sheep=sheep, wolves=wolves, regrowth=regrowth, sheep_birth=births[0], wolf_birth=births[1])
    for meadow in in_both(WolfSheep, "predation", **values):
        for one, other in zip(ends(meadow, ["sheep", "wolves", "grass"], steps=steps, seeds=80), theirs):
            require_same_means(one, other)


def test_headings_that_are_all_noise_have_the_order_of_random_directions():
    count = 300
    flock = gridlock.Simulation(model=Flock(count=count, noise=2 * math.pi), box={"width": 7.0, "height": 5.0, "edge": "periodic"}, observe={"every": 1})
    flock.run(steps=250)
    require_mean(flock.series["order"][1:], math.sqrt(math.pi / (4 * count)))


def test_the_flock_is_that_of_cpp():
    box = {"width": 5.0, "height": 4.0, "edge": "periodic"}
    values = dict(count=100, radius=1.0, speed=0.1, noise=3.0)
    ours = ends({"model": Flock(**values), "box": box}, ["order"], steps=40, seeds=30)[0]
    theirs = ends({"model.kind": "flocking", "flocking": values, "box": box}, ["order"], steps=40, seeds=30)[0]
    require_same_means(ours, theirs)


def boids_in_turns(count, side, radius, steps, seed, speed=1.0, separation=1.0, cohesion=0.03, apart=0.015, alignment=0.05):
    """The rules of the public comparison, with a search over all birds in each turn; returns the order and the mean square gap to all others."""
    draw = np.random.default_rng(seed)
    places, angle = draw.random((count, 2)) * side, 2 * math.pi * draw.random(count)
    headings = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for _ in range(steps):
        for bird in draw.permutation(count):
            gaps = places - places[bird]
            gaps -= side * np.rint(gaps / side)
            distances = np.hypot(*gaps.T)
            near = (distances <= radius) & (np.arange(count) != bird)
            wish = cohesion * gaps[near].sum(axis=0) - apart * gaps[near & (distances < separation)].sum(axis=0) + alignment * headings[near].sum(axis=0)
            heading = headings[bird] + wish / max(near.sum(), 1)
            headings[bird] = heading / np.hypot(*heading)
            places[bird] = (places[bird] + speed * headings[bird]) % side
    return np.hypot(*headings.mean(axis=0)), spread_of(places, side)


def spread_of(places, side):
    gaps = places[:, None] - places[None]
    return ((gaps - side * np.rint(gaps / side)) ** 2).mean()


def test_boids_are_those_of_the_public_comparison():
    count, side, radius, steps = 30, 20.0, 5.0, 12
    ours = ends({"model": Boids(count=count, radius=radius), "box": {"width": side, "height": side, "edge": "periodic"}}, ["order", "spread"], steps=steps,
                seeds=40, measure=lambda one: {"order": one.series["order"][-1], "spread": spread_of(one.frame.positions, side)})
    theirs = np.array([boids_in_turns(count, side, radius, steps, seed) for seed in range(25)]).T
    for one, other in zip(ours, theirs):
        require_same_means(one, other)


def test_boids_of_cpp_follow_that_rule_all_at_once():
    count, side, radius, speed = 60, 20.0, 5.0, 0.7
    flock = gridlock.Simulation({"model.kind": "flocking", "flocking": {"rule": "boids", "count": count, "radius": radius, "speed": speed},
                                 "box": {"width": side, "height": side, "edge": "periodic"}})

    def seen(frame):
        order = np.argsort(frame.ids)
        return frame.positions[order], np.stack([frame.heading_x, frame.heading_y], axis=1)[order]

    places, headings = seen(flock.frame)
    for _ in range(5):
        gaps = places[None] - places[:, None]
        gaps -= side * np.rint(gaps / side)
        distances = np.hypot(*np.moveaxis(gaps, 2, 0)) + radius * 2 * np.eye(count)
        near, close = ((distances < reach).astype(float) for reach in (radius, 1.0))
        wish = 0.03 * np.einsum("ij,ijk->ik", near, gaps) - 0.015 * np.einsum("ij,ijk->ik", close, gaps) + 0.05 * near @ headings
        headings = headings + wish / np.maximum(near.sum(axis=1), 1)[:, None]
        headings /= np.hypot(*headings.T)[:, None]
        places = (places + speed * headings) % side
    flock.run(steps=5)
    assert all(np.allclose(one, other, atol=1e-9) for one, other in zip(seen(flock.frame), (places, headings)))


def test_a_bird_alone_flies_straight_on():
    bird = gridlock.Simulation(model=Boids(count=1), box={"width": 30.0, "height": 20.0, "edge": "periodic"})
    place, heading = bird.frame.positions[0], np.array([bird.frame.heading_x[0], bird.frame.heading_y[0]])
    bird.run(steps=50)
    assert np.allclose(bird.frame.positions[0], (place + 50 * heading) % [30.0, 20.0], atol=1e-9)


def test_disks_placed_at_random_overlap_as_often_as_chance_has_it():
    count, fraction = 200, 0.2
    (active,) = ends({"model": RandomOrganization(count=count, packing_fraction=fraction), **PERIODIC}, ["active"], steps=0, seeds=80)
    require_mean(active, 1 - (1 - 4 * fraction / count) ** (count - 1))


def random_organization_in_plain_numpy(count, fraction, kick, steps, seed):
    draw = np.random.default_rng(seed)
    diameter = math.sqrt(4 * fraction / (math.pi * count))
    places = draw.random((count, 2))

    def overlapping():
        between = places[:, None] - places[None]
        between -= np.rint(between)
        return ((between**2).sum(axis=2) < diameter**2).sum(axis=1) > 1

    for _ in range(steps):
        length, angle = draw.random(count) * kick * diameter * overlapping(), 2 * math.pi * draw.random(count)
        places = (places + np.stack([length * np.cos(angle), length * np.sin(angle)], axis=1)) % 1.0
    return overlapping().mean()


def test_random_organization_is_that_of_its_rule():
    values = dict(count=50, packing_fraction=0.35, kick=0.5)
    (ours,) = ends({"model": RandomOrganization(**values), **PERIODIC}, ["active"], steps=15, seeds=80)
    theirs = [random_organization_in_plain_numpy(*values.values(), 15, seed) for seed in range(80)]
    require_same_means(ours, theirs)


def test_few_disks_come_to_rest_for_ever():
    disks = gridlock.Simulation(model=RandomOrganization(count=300, packing_fraction=0.2), box={"edge": "periodic"},
                                observe={"every": 1})
    assert gridlock.run_until(disks, "active == 0", steps=2000).step > 5
    rest = disks.frame.positions
    disks.run(steps=20)
    assert np.array_equal(disks.frame.positions, rest)


def test_disks_without_room_never_come_to_rest():
    disks = gridlock.Simulation(model=RandomOrganization(count=100, packing_fraction=0.92), box={"edge": "periodic"}, observe={"every": 1})
    assert gridlock.run_until(disks, "active == 0", steps=100) is None


def test_the_sick_recover_at_their_rate():
    settings = {"model": SIR(count=400, infected_at_start=1.0, time_step=0.1), **PERIODIC}
    require_mean(ends(settings, ["infected"], steps=20, seeds=30)[0], 400 * (1 - 0.02) ** 20)


@pytest.mark.parametrize("edge", ["periodic", "wall"])
def test_the_disease_is_that_of_cpp(edge):
    values = dict(count=250, radius=0.05, speed=0.1, turning_rate=2.0, infection_rate=1.0, recovery_rate=0.4, infected_at_start=0.04)
    names = ["infected", "recovered"]
    ours = ends({"model": SIR(**values, time_step=0.1), "box.edge": edge}, names, steps=30, seeds=30)
    theirs = ends({"model.kind": "epidemic", "epidemic": {**values, "step_length": 0.1}, "box.edge": edge}, names, steps=30, seeds=30)
    for one, other in zip(ours, theirs):
        require_same_means(one, other)


def variance_of_the_urn(k, n, ants):
    """Of the number of ants on one branch, from the exact probabilities of all numbers."""
    chances = np.array([1.0])
    for gone in range(ants):
        first = np.arange(gone + 1)
        takes = (k + first) ** n / ((k + first) ** n + (k + gone - first) ** n)
        chances = np.append(chances * (1 - takes), 0.0) + np.insert(chances * takes, 0, 0.0)
    return np.sum(chances * (np.arange(ants + 1) - ants / 2) ** 2)


@pytest.mark.parametrize("k, n", [(5.0, 1), (20.0, 2)])
def test_ants_choose_as_the_balls_of_an_urn_before_any_comes_back(k, n):
    ants = 38
    (first,) = ends({"model": Ants(count=ants, k=k, n=n), **WALLS}, ["first"], steps=ants, seeds=100,
                    measure=lambda one: {"first": one.frame.fields["scent"][0, 0]})
    require_mean(first, ants / 2)
    expected = variance_of_the_urn(k, n, ants)
    assert n != 1 or math.isclose(expected, ants / 4 * (2 * k + ants) / (2 * k + 1))
    require_mean((first - ants / 2) ** 2, expected)


def test_ants_come_to_take_the_short_branch():
    (first,) = ends({"model": Ants(count=200, flow=2, detour=3.0), **WALLS}, ["first_branch"], steps=250, seeds=16)
    assert first.mean() - 0.5 > 3.5 * first.std(ddof=1) / np.sqrt(16)


def test_ants_leave_their_scent_on_the_whole_way():
    bridge = gridlock.Simulation(model=Ants(count=1, detour=1.5), box={"edge": "wall"})
    gridlock.run_until(bridge, lambda one: one.counts["trips"] == 1, steps=100)
    ant, scent = bridge.frame, bridge.frame.fields["scent"]
    assert bridge.clock.step in (41, 51, 61) and np.allclose(scent.sum(axis=0)[1:], 2.0) and ant.way[0] == 1


def size_of_an_epidemic(susceptible, infected, infection, recovery, edge):
    """The exact mean number of those who are ever infected, where each pair has an edge with a probability (Ball 1986, doi:10.2307/1427301)."""
    lasts = np.arange(1, 2000)
    chances = recovery * (1 - recovery) ** (lasts - 1.0)
    spares = 1 - edge + edge * (1 - infection) ** lasts
    spares_all = [np.sum(chances * spares**k) for k in range(susceptible + 1)]
    sizes = []
    for size in range(susceptible + 1):
        known = sum(math.comb(susceptible - j, size - j) * sizes[j] / spares_all[susceptible - size] ** (infected + j) for j in range(size))
        sizes.append((math.comb(susceptible, size) - known) * spares_all[susceptible - size] ** (infected + size))
    assert math.isclose(sum(sizes), 1.0, rel_tol=1e-6) and min(sizes) > -1e-9
    return infected + np.dot(range(susceptible + 1), sizes)


@pytest.mark.parametrize("network, recovery", [("complete", 1.0), ("complete", 0.4), ("at random", 1.0), ("at random", 0.4)])
def test_an_epidemic_on_a_network_is_as_large_as_ball_has_it(network, recovery):
    count, degree = 20, 4
    infection = 0.3 if network == "at random" else 0.07
    model = SIRNetwork(count=count, network=network, degree=degree, infected_at_start=0.1, infection=infection, recovery=recovery)
    sizes = ends({"model": model}, ["recovered"], steps=1000, seeds=100, until="infected == 0", every=4)[0]
    require_mean(sizes, size_of_an_epidemic(18, 2, infection, recovery, degree / (count - 1) if network == "at random" else 1.0))


@pytest.mark.parametrize("network", ["scale free", "small world"])
def test_those_without_recovery_infect_all_whom_a_network_joins_to_them(network):
    people = gridlock.Simulation(model=SIRNetwork(count=200, network=network, infection=1.0, recovery=0.0, infected_at_start=0.005))
    edges, sick = people.frame.networks["contacts"].ids, people.frame.health == 1
    for _ in range(3):
        sick[edges[sick[edges].any(axis=1)]] = True
        people.run(steps=1)
        assert np.array_equal(people.frame.health == 1, sick) and 1 < sick.sum()


@pytest.mark.parametrize("convinced", ["anyone", "oldest"])
def test_voters_agree_on_an_opinion_as_often_as_its_weight_by_degrees(convinced):
    model = Voter(count=20, network="scale free", degree=2, yes_at_start=0.2, convinced=convinced)
    agreed, weight = ends({"model": model}, ["agreed", "weight"], steps=2000, seeds=120, until="disputes == 0", every=8,
                          measure=lambda one: {"agreed": one.series["yes"][-1], "weight": one.series["weighted_yes"][0]})
    assert set(agreed) == {0.0, 1.0} and (weight.mean() > 0.3) == (convinced == "oldest")
    require_mean(agreed - weight, 0.0)


@pytest.mark.parametrize("activity", [0.5, 1.0])
def test_disputes_on_a_complete_network_fall_as_two_walkers_meet(activity):
    count, steps = 30, 10
    (disputes,) = ends({"model": Voter(count=count, network="complete", yes_at_start=0.5, activity=activity)}, ["disputes"], steps=steps, seeds=100)
    meet = 2 * activity * (1 - activity) / (count - 1) + activity**2 * (count - 2) / (count - 1) ** 2
    require_mean(disputes, (count / 2) / (count - 1) * (1 - meet) ** steps)


def test_voters_copy_their_neighbours():
    voters = gridlock.Simulation(model=Voter(count=100, network="small world", rewiring=0.0, degree=2, activity=1.0))
    before = voters.frame.opinion.copy()
    voters.run(steps=1)
    left, right = np.roll(before, 1), np.roll(before, -1)
    after = voters.frame.opinion
    assert np.all((after == left) | (after == right)) and voters.counts["changes"] == np.count_nonzero(after != before) > 0


MODELS = [getattr(gridlock.library, name) for name in gridlock.library.__all__]


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_a_model_of_the_library_says_what_it_is_and_goes_on_with_the_same_bits(model, tmp_path):
    assert "Source: " in model.__doc__ and "doi:" in model.__doc__ and "Cost: " in model.__doc__
    settings = {name: value for name, value in vars(model).items() if isinstance(value, gridlock.Setting)}
    assert settings and all(one.documentation and (one.choices or isinstance(one.default, bool) or one.least > -math.inf) for one in settings.values())
    box = {"width": 30.0, "height": 30.0, "edge": "periodic"} if model is Boids else {"edge": "wall"}
    shared = {"model": model, "box": box, "observe.every": 4}
    gridlock.run({**shared, "run.steps": 12}, tmp_path / "whole")
    gridlock.run({**shared, "run.steps": 7}, tmp_path / "parts")
    gridlock.open(tmp_path / "parts").resume(steps=12)
    whole = gridlock.open(tmp_path / "whole")
    assert set(model.observations) < set(whole.series.dtype.names)
    assert whole.summary["state_hash"] == gridlock.open(tmp_path / "parts").summary["state_hash"]


def test_a_model_of_the_library_can_be_copied_as_a_file(tmp_path):
    for model in MODELS:
        shutil.copy(sys.modules[model.__module__].__file__, tmp_path)
    names = [model.__module__.rpartition(".")[2] for model in MODELS]
    script = f"import gridlock, {', '.join(names)}\n" + "".join(
        f"gridlock.Simulation(model='{model.name}', box={{'width': 30.0, 'height': 30.0, 'edge': '{'periodic' if model is Boids else 'wall'}'}}).run(steps=1)\n"
        for model in MODELS)
    result = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr


REFUSED = {
    "a city without edges": ({"model": Schelling, "box.edge": "periodic"}, 'the city of schelling has edges'),
    "a sky with edges": ({"model": Boids, **WALLS}, "the sky of boids has no edges"),
    "a sky that is too small": ({"model": Boids, **PERIODIC}, "birds see and move as far as 6 in a box of 1 × 1"),
    "more agents than cells": ({"model": Schelling(count=2000), **WALLS}, "2000 agents have 1600 cells"),
    "more than certain": ({"model": SIR(infection_rate=50.0), **WALLS}, "infection_rate · time_step is 2.5, but is a probability"),
    "an odd number of contacts": ({"model": SIRNetwork(degree=5)}, "each of 2000 people has 5 contacts"),
    "more acquaintances than voters": ({"model": Voter(count=6)}, "each of 6 voters has 6 acquaintances"),
    "more agents than cells of sugar": ({"model": Sugarscape(count=2501)}, "2501 agents have 2500 cells"),
    "a view around the world": ({"model": Sugarscape(side=12)}, "agents of sugarscape see 6 cells far on 12"),
    "ages in the wrong order": ({"model": Sugarscape(lifespan=30)}, "min_lifespan of sugarscape is 60 and lifespan 30"),
    "a density above 1": ({"model": ForestFire(density=1.5)}, "forest_fire.density"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_the_library_refuses(case):
    settings, words = REFUSED[case]
    with pytest.raises(gridlock.Error) as error:
        gridlock.Simulation(settings)
    assert words in str(error.value)
