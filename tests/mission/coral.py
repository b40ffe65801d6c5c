"""The coral mission of the mission paper (its section 8) as a plan, and larger ones of its kind.

What the paper leaves open: the five motion activities take the location and the thruster, filming and measuring
nothing; filming and advancing are mandatory, measuring the temperature is optional.
"""

from __future__ import annotations

from mauve.mission.plan import (
    Activity,
    Alternative,
    Child,
    Elementary,
    Hardware,
    Mission,
    OnRecovery,
    Parallel,
    Sequence,
    Software,
    Step,
)

MOTIONS = ("manual_moving", "isospheric_observation", "diving", "advancing", "go_surface")


def one(name: str, consumes: tuple[str, ...] = (), produces: tuple[str, ...] = ()) -> Activity:
    """An activity without choice."""
    return Activity(name, (Alternative("only", consumes, produces),))


def coral(sensors: int = 1, repeat: int = 1, copies: int = 1, shared: bool = False) -> Mission:
    """The mission with so many GPS and IMU sensors each, its objectives repeated, or the whole robot copied."""
    activities: list[Activity] = []
    software: list[Software] = []
    hardware: list[Hardware] = []
    steps: list[Step] = []
    for copy in range(copies):
        tag = f"_{copy + 1}" if copies > 1 else ""
        kinds = [f"{kind}{n + 1 if sensors > 1 else ''}{tag}" for kind in ("gps", "imu") for n in range(sensors)]
        hardware += [Hardware(f"{kind}_sensor") for kind in kinds] + [Hardware(f"thruster_actuator{tag}")]
        software += [Software(f"{kind}_data") for kind in kinds]
        software += [Software(f"location{tag}", shared=shared), Software(f"thrust{tag}")]
        activities += [one(f"{kind}_driver", (f"{kind}_sensor",), (f"{kind}_data",)) for kind in kinds]
        activities += [one(f"thruster_driver{tag}", (f"thruster_actuator{tag}",), (f"thrust{tag}",))]
        ways = tuple(Alternative(kind, (f"{kind}_data",), (f"location{tag}",)) for kind in kinds)
        activities += [Activity(f"localisation{tag}", ways, OnRecovery.KEEP)]
        for again in range(repeat):
            own = tag + (f"_r{again + 1}" if repeat > 1 else "")
            activities += [one(f"{name}{own}", (f"location{tag}", f"thrust{tag}")) for name in MOTIONS]
            activities += [one(f"filming{own}"), one(f"temperature{own}")]
            steps += _objectives(own)
    name = "Coral"
    return Mission(name, Sequence(name, tuple(steps)), tuple(activities), tuple(software), tuple(hardware))


def _objectives(own: str) -> list[Step]:
    def does(name: str, activity: str) -> Elementary:
        return Elementary(f"{name}{own}", (f"{activity}{own}",))

    observation = Sequence(
        f"LocalizedObservation{own}",
        (Step(does("ManualMoving", "manual_moving")), Step(does("Isospheric", "isospheric_observation"))),
    )
    survey = Parallel(
        f"Survey{own}",
        (
            Child(Step(does("Filming", "filming"))),
            Child(Step(does("Advancing", "advancing"))),
            Child(Step(does("MeasuringTemperature", "temperature")), mandatory=False),
        ),
    )
    transect = Sequence(
        f"Transect{own}", (Step(does("Diving", "diving")), Step(survey), Step(does("GoingUp", "go_surface")))
    )
    return [Step(observation), Step(transect)]
