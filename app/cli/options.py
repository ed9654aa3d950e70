"""Options that several commands share, and those of the commands in commands.py."""

from __future__ import annotations

import argparse

from granchain_core.run.budget import BUDGET

from .picture import add_option as add_picture


def add_scene(parser: argparse.ArgumentParser) -> None:
    """SCENE and its knobs."""
    parser.add_argument("scene", metavar="SCENE")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a knob")


def add_json(parser: argparse.ArgumentParser) -> None:
    """The choice between words and one JSON object."""
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout")


def add_result(parser: argparse.ArgumentParser) -> None:
    """A scene, the accuracy asked for, and the file that keeps the result."""
    add_scene(parser)
    parser.add_argument("--accuracy", metavar="E", help="the same as --set accuracy=E")
    parser.add_argument("--out", metavar="FILE", help="write an HDF5 file")
    add_json(parser)


def add_nothing(parser: argparse.ArgumentParser) -> None:
    """For a command that takes no options."""


def add_serve(parser: argparse.ArgumentParser) -> None:
    """Where the dashboard is served."""
    parser.add_argument("--port", type=int, default=5006)
    parser.add_argument("--address", default="127.0.0.1")
    parser.add_argument("--allow-websocket-origin", action="append", metavar="HOST",
                        help="host name under which browsers may reach a dashboard behind a proxy")


def add_run(parser: argparse.ArgumentParser) -> None:
    """What is run, recorded and explained."""
    add_result(parser)
    parser.add_argument("--periods", type=int, default=100, metavar="P", help="periods run and discarded")
    parser.add_argument("--record", type=int, default=20, metavar="R", help="periods recorded")
    parser.add_argument("--samples", type=int, default=96, metavar="S", help="samples a period")
    parser.add_argument("--method", metavar="M", help="integration method instead of the one accuracy chooses")
    parser.add_argument("--budget", type=float, default=BUDGET, metavar="SECONDS", help="refuse what would take longer")
    parser.add_argument("--explain", action="store_true", help="say which effects and method are used, and why")


def add_curve(parser: argparse.ArgumentParser) -> None:
    """The frequencies of a curve and how it is swept."""
    add_result(parser)
    parser.add_argument("--from", dest="low", type=float, required=True, metavar="F", help="lowest frequency [Hz]")
    parser.add_argument("--to", dest="high", type=float, required=True, metavar="F", help="highest frequency [Hz]")
    parser.add_argument("--points", type=int, required=True, metavar="n")
    parser.add_argument("--start", default="rest", metavar="rest|up|down")
    add_picture(parser)


def add_accuracy(parser: argparse.ArgumentParser) -> None:
    """A scene whose accuracy is measured."""
    add_scene(parser)
    add_json(parser)
    add_picture(parser)
