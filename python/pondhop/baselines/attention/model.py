"""The attention model in PyTorch: encoder, decoder and the two problems it is trained on.

Used for training only; inference in the core repeats this file without PyTorch and is tested against its logits.

`Variant.cvrp` is the model of Kool, van Hoof and Welling (Attention, Learn to Solve Routing Problems!, ICLR 2019) on
the problem that the paper trained it on: unit demands, a capacity a route, the total length. `Variant.minmax` is ours:
a fixed number of routes, the longest route, and what a decoder needs for it. It differs in the inputs (centred on the
depot, scaled, with the spacing of the ponds), in the state that the decoder sees, in a learned aversion to long legs,
and in masks that never allow a route too many.

A forward pass costs O(n^2) for the encoder and O(n^2) for all steps of one rollout. Linear maps of nodes that a step
would repeat for every rollout are applied once a farm: the last node's part of the query, and the projection of the
glimpse, which moves to the keys of the logits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor, nn
from torch.nn import functional

Variant = Literal["cvrp", "minmax"]
NUM_DEPOT_FEATURES = {"cvrp": 2, "minmax": 4}
NUM_POND_FEATURES = {"cvrp": 3, "minmax": 4}
NUM_STATE_FEATURES = {"cvrp": 1, "minmax": 7}
LOGIT_BOUNDS = {"cvrp": 10.0, "minmax": 15.0}
"""How far logits reach before distance is taken off; farther where a few unlikely choices spoil a long route."""
TOTAL_WEIGHT = 0.1
"""Weight of the mean route length beside the longest route in the cost of ``minmax``."""


@dataclass(frozen=True)
class Architecture:
    """What the shapes of the weights follow from."""

    variant: Variant
    width: int = 128
    num_heads: int = 8
    num_layers: int = 3
    feed_forward_width: int = 512


@dataclass(frozen=True, eq=False)
class Farms:
    """Farms of one size as the network sees them.

    Attributes
    ----------
    positions
        Of the depot (node 0) and the ponds, in the network's coordinates, shape (farms, n + 1, 2).
    depot_features, pond_features
        Inputs of the encoder, shapes (farms, 1, features) and (farms, n, features).
    distances
        Between all nodes, shape (farms, n + 1, n + 1).
    spacing
        Mean distance from a pond to the nearest other pond, shape (farms,).
    num_routes
        Routes allowed (``minmax``), or what the capacity n // num_routes + 1 follows from (``cvrp``).
    """

    positions: Tensor
    depot_features: Tensor
    pond_features: Tensor
    distances: Tensor
    spacing: Tensor
    num_routes: int

    @property
    def num_ponds(self) -> int:
        """Ponds of each farm."""
        return int(self.positions.shape[1]) - 1


@dataclass(frozen=True, eq=False)
class Encoding:
    """What the decoder reads of a farm, the same for all of its rollouts.

    Attributes
    ----------
    query
        The part of a step's query that follows from the last node, shape (farms, nodes, width).
    keys, values
        Of the glimpse, shape (farms, heads, nodes, width / heads).
    logit_keys
        Through the projection of the glimpse, shape (farms, width, nodes).
    aversion
        What the logits lose by the distance of last and next node, shape (farms, nodes, nodes); absent for ``cvrp``.
    """

    query: Tensor
    keys: Tensor
    values: Tensor
    logit_keys: Tensor
    aversion: Tensor | None


@dataclass(frozen=True, eq=False)
class Rollouts:
    """Routes that the decoder chose, and the steps that it chose them in.

    Attributes
    ----------
    actions, last_nodes
        Node chosen and node left at each step, shape (farms, rollouts, steps). A rollout that is done stays at 0.
    states
        State features of each step, shape (farms, rollouts, steps, features).
    masks
        0 where a node may be chosen, else minus infinity, shape (farms, rollouts, steps, nodes).
    logits
        Of each step if they were asked for, shape as `masks`.
    max_lengths, total_lengths
        Longest route and sum of the routes in the network's coordinates, shape (farms, rollouts).
    num_routes
        Routes used, shape (farms, rollouts).
    """

    actions: Tensor
    last_nodes: Tensor
    states: Tensor
    masks: Tensor
    logits: Tensor | None
    max_lengths: Tensor
    total_lengths: Tensor
    num_routes: Tensor

    def select(self, indices: Tensor) -> Rollouts:
        """Return some rollouts of each farm, `indices` of shape (farms, selected)."""
        farms = torch.arange(len(indices), device=indices.device)[:, None]
        return Rollouts(
            self.actions[farms, indices],
            self.last_nodes[farms, indices],
            self.states[farms, indices],
            self.masks[farms, indices],
            None if self.logits is None else self.logits[farms, indices],
            self.max_lengths[farms, indices],
            self.total_lengths[farms, indices],
            self.num_routes[farms, indices],
        )


def farms_of(variant: Variant, positions: Tensor, num_routes: int) -> Farms:
    """Return what the network sees of farms.

    Parameters
    ----------
    variant
        Whose inputs.
    positions
        Of depot (node 0) and ponds, shape (farms, n + 1, 2), float64 or float32; within the unit square for ``cvrp``.
    num_routes
        Routes allowed.
    """
    if variant == "minmax":
        positions = positions - positions[:, :1]
        radius = positions.norm(dim=2).amax(dim=1)
        positions = positions / torch.where(radius > 0, radius, 1.0)[:, None, None]
    positions = positions.to(torch.float32)
    distances = (positions[:, :, None] - positions[:, None, :]).norm(dim=3)
    num_ponds = positions.shape[1] - 1
    if num_ponds > 1:
        between = distances[:, 1:, 1:] + torch.diag(torch.full((num_ponds,), math.inf, device=positions.device))
        nearest = between.amin(dim=2)
    else:
        nearest = torch.ones_like(distances[:, 1:, 0])
    spacing = nearest.mean(dim=1)
    if variant == "minmax":
        radii = distances[:, 1:, :1]
        pond_features = torch.cat((positions[:, 1:], radii, nearest[:, :, None]), dim=2)
        depot_features = torch.zeros_like(pond_features[:, :1])
        depot_features[:, 0, 3] = spacing
    else:
        demands = torch.full_like(distances[:, 1:, :1], 1 / capacity(num_ponds, num_routes))
        pond_features = torch.cat((positions[:, 1:], demands), dim=2)
        depot_features = positions[:, :1]
    return Farms(positions, depot_features, pond_features, distances, spacing, num_routes)


def capacity(num_ponds: int, num_routes: int) -> int:
    """Return how many ponds a route of ``cvrp`` may have; the paper: n / 5 + 1."""
    return num_ponds // num_routes + 1


class EncoderLayer(nn.Module):
    """Multi-head self-attention and a feed-forward map, each with a skip connection and batch normalisation."""

    def __init__(self, architecture: Architecture) -> None:
        super().__init__()
        width = architecture.width
        self.num_heads = architecture.num_heads
        self.query = nn.Linear(width, width, bias=False)
        self.key = nn.Linear(width, width, bias=False)
        self.value = nn.Linear(width, width, bias=False)
        self.output = nn.Linear(width, width, bias=False)
        self.attention_norm = nn.BatchNorm1d(width)
        self.hidden = nn.Linear(width, architecture.feed_forward_width)
        self.contract = nn.Linear(architecture.feed_forward_width, width)
        self.feed_forward_norm = nn.BatchNorm1d(width)

    def forward(self, nodes: Tensor) -> Tensor:
        """Return embeddings of nodes from those of the layer before, shape (farms, nodes, width)."""
        shape = nodes.shape
        heads = (shape[0], shape[1], self.num_heads, -1)
        attended = functional.scaled_dot_product_attention(
            self.query(nodes).view(heads).transpose(1, 2),
            self.key(nodes).view(heads).transpose(1, 2),
            self.value(nodes).view(heads).transpose(1, 2),
        )
        nodes = nodes + self.output(attended.transpose(1, 2).reshape(shape))
        nodes = self.attention_norm(nodes.view(-1, shape[2]))
        nodes = self.feed_forward_norm(nodes + self.contract(functional.relu(self.hidden(nodes))))
        return nodes.view(shape)


class AttentionModel(nn.Module):
    """Encoder and decoder of one variant."""

    def __init__(self, architecture: Architecture) -> None:
        super().__init__()
        self.architecture = architecture
        width, variant = architecture.width, architecture.variant
        self.depot = nn.Linear(NUM_DEPOT_FEATURES[variant], width)
        self.pond = nn.Linear(NUM_POND_FEATURES[variant], width)
        self.layers = nn.ModuleList(EncoderLayer(architecture) for _ in range(architecture.num_layers))
        self.fixed = nn.Linear(width, width, bias=False)
        self.node = nn.Linear(width, 3 * width, bias=False)
        self.step = nn.Linear(width + NUM_STATE_FEATURES[variant], width, bias=False)
        self.glimpse = nn.Linear(width, width, bias=False)
        if variant == "minmax":
            self.distance = nn.Parameter(torch.tensor(0.0))

    def encode(self, farms: Farms) -> Encoding:
        """Return what the decoder reads of the farms."""
        nodes = torch.cat((self.depot(farms.depot_features), self.pond(farms.pond_features)), dim=1)
        for layer in self.layers:
            nodes = layer(nodes)
        width = self.architecture.width
        heads = (nodes.shape[0], nodes.shape[1], self.architecture.num_heads, -1)
        keys, values, logit_keys = self.node(nodes).split(width, dim=2)
        query = functional.linear(nodes, self.step.weight[:, :width]) + self.fixed(nodes.mean(dim=1, keepdim=True))
        aversion = None
        if self.architecture.variant == "minmax":
            spacing = torch.where(farms.spacing > 0, farms.spacing, 1.0)[:, None, None]
            aversion = functional.softplus(self.distance) * torch.log1p(farms.distances / spacing)
        return Encoding(
            query,
            keys.reshape(heads).transpose(1, 2).contiguous(),
            values.reshape(heads).transpose(1, 2).contiguous(),
            (logit_keys @ self.glimpse.weight / math.sqrt(width)).transpose(1, 2).contiguous(),
            aversion,
        )

    def logits(self, encoding: Encoding, last_nodes: Tensor, states: Tensor, mask: Tensor) -> Tensor:
        """Return the logits of choices.

        Parameters
        ----------
        encoding
            Of the farms.
        last_nodes
            Where each choice is made, shape (farms, choices).
        states
            State features, shape (farms, choices, features).
        mask
            0 or minus infinity, shape (farms, choices, nodes).

        Returns
        -------
        Tensor
            Shape as `mask`, minus infinity where masked.
        """
        num_farms, num_nodes, width = encoding.query.shape
        offsets = torch.arange(num_farms, device=last_nodes.device)[:, None] * num_nodes
        query = functional.embedding(last_nodes + offsets, encoding.query.reshape(-1, width))
        query = query + functional.linear(states, self.step.weight[:, width:])
        heads = (num_farms, -1, self.architecture.num_heads, width // self.architecture.num_heads)
        glimpse = functional.scaled_dot_product_attention(
            query.view(heads).transpose(1, 2), encoding.keys, encoding.values, attn_mask=mask[:, None]
        )
        glimpse = glimpse.transpose(1, 2).reshape(query.shape)
        logits = LOGIT_BOUNDS[self.architecture.variant] * torch.tanh(torch.bmm(glimpse, encoding.logit_keys))
        if encoding.aversion is not None:
            aversion = functional.embedding(last_nodes + offsets, encoding.aversion.reshape(-1, num_nodes))
            logits = logits - aversion
        return logits + mask

    def log_likelihood(self, encoding: Encoding, rollouts: Rollouts) -> Tensor:
        """Return the log-probability of rollouts in one pass over all of their steps, shape (farms, rollouts)."""
        num_farms, num_rollouts, num_steps = rollouts.actions.shape
        logits = self.logits(
            encoding, rollouts.last_nodes.flatten(1), rollouts.states.flatten(1, 2), rollouts.masks.flatten(1, 2)
        )
        chosen = logits.gather(2, rollouts.actions.flatten(1)[:, :, None])[:, :, 0] - logits.logsumexp(dim=2)
        return chosen.view(num_farms, num_rollouts, num_steps).sum(dim=2)


@torch.no_grad()
def roll_out(
    model: AttentionModel,
    farms: Farms,
    encoding: Encoding,
    num_rollouts: int,
    *,
    is_greedy: bool = False,
    keeps_logits: bool = False,
) -> Rollouts:
    """Decode routes for farms, at each step the likeliest node or one drawn with its probability.

    Parameters
    ----------
    model, farms, encoding
        The network, the farms and what it made of them.
    num_rollouts
        Rollouts a farm; more than one is useful only if they are drawn.
    is_greedy
        Choose the likeliest node.
    keeps_logits
        Return the logits of all steps.
    """
    routing = _Routing(model.architecture.variant, farms, num_rollouts)
    steps = []
    while not routing.is_done():
        state, mask = routing.state(), routing.mask()
        logits = model.logits(encoding, routing.last, state, mask)
        if is_greedy:
            action = logits.argmax(dim=2)
        else:
            # One uniform number a choice; below 1 by more than rounding, it never passes the last open node.
            cumulative = logits.exp().cumsum(dim=2)
            threshold = torch.rand_like(cumulative[:, :, :1]) * (1 - 1e-6) * cumulative[:, :, -1:]
            action = (cumulative <= threshold).sum(dim=2)
        steps.append((action, routing.last, state, mask, logits if keeps_logits else None))
        routing.choose(action)
    actions, last_nodes, states, masks, logits_of_steps = zip(*steps, strict=True)
    routing.return_home()
    return Rollouts(
        torch.stack(actions, dim=2),
        torch.stack(last_nodes, dim=2),
        torch.stack(states, dim=2),
        torch.stack(masks, dim=2),
        torch.stack(logits_of_steps, dim=2) if keeps_logits else None,
        routing.longest,
        routing.total,
        routing.num_closed,
    )


def costs(variant: Variant, farms: Farms, rollouts: Rollouts) -> Tensor:
    """Return what training minimises, in the network's coordinates, shape (farms, rollouts)."""
    if variant == "cvrp":
        return rollouts.total_lengths
    return rollouts.max_lengths + TOTAL_WEIGHT * rollouts.total_lengths / farms.num_routes


class _Routing:
    """Where rollouts stand: what they have flown, what is open to them, and how the decoder sees it."""

    def __init__(self, variant: Variant, farms: Farms, num_rollouts: int) -> None:
        shape = (farms.positions.shape[0], num_rollouts)
        device = farms.positions.device
        self.variant = variant
        self.num_ponds, self.num_routes = farms.num_ponds, farms.num_routes
        self.capacity = capacity(farms.num_ponds, farms.num_routes)
        self.distances = farms.distances.flatten(1)
        self.home = farms.distances[:, :, 0].contiguous()
        self.visited = torch.zeros((*shape, farms.num_ponds + 1), device=device)
        self.last = torch.zeros(shape, dtype=torch.int64, device=device)
        self.num_left = torch.full(shape, float(farms.num_ponds), device=device)
        self.num_in_route = torch.zeros(shape, device=device)
        self.num_closed = torch.zeros(shape, device=device)
        self.current = torch.zeros(shape, device=device)
        self.longest = torch.zeros(shape, device=device)
        self.total = torch.zeros(shape, device=device)

    def is_done(self) -> bool:
        return not self.num_left.any()

    def state(self) -> Tensor:
        if self.variant == "cvrp":
            return (1 - self.num_in_route / self.capacity)[:, :, None]
        routes_left = self.num_routes - self.num_closed
        home = self.home.gather(1, self.last)
        left_per_route = self.num_left / routes_left * (self.num_routes / self.num_ponds)
        return torch.stack(
            (
                routes_left / self.num_routes,
                self.current,
                home,
                self.longest,
                self.num_left / self.num_ponds,
                left_per_route,
                self.current + home - self.longest,
            ),
            dim=2,
        )

    def mask(self) -> Tensor:
        if self.variant == "cvrp":
            mask = self.visited.masked_fill((self.num_in_route >= self.capacity)[:, :, None], -math.inf)
            mask[:, :, 0] = 0
            may_close = self.num_in_route > 0
        else:
            mask = self.visited.clone()
            may_close = (self.num_in_route > 0) & (self.num_closed < self.num_routes - 1)
        mask[:, :, 0].masked_fill_(~(may_close | (self.num_left == 0)), -math.inf)
        return mask

    def choose(self, action: Tensor) -> None:
        leg = self.distances.gather(1, self.last * (self.num_ponds + 1) + action)
        is_pond = action > 0
        is_closing = (self.num_in_route > 0) & ~is_pond
        self.total = self.total + leg
        self.current = self.current + leg
        self.longest = torch.where(is_closing, torch.maximum(self.longest, self.current), self.longest)
        self.num_closed = self.num_closed + is_closing
        self.current = self.current * is_pond
        self.num_in_route = (self.num_in_route + 1) * is_pond
        self.num_left = self.num_left - is_pond.float()
        self.visited.scatter_(2, action[:, :, None], -math.inf)
        self.visited[:, :, 0] = 0
        self.last = action

    def return_home(self) -> None:
        self.choose(torch.zeros_like(self.last))
