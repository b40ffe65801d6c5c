"""The actions of all rules of the grammar, by the rule's name. A rule without one passes its only child on."""

from __future__ import annotations

from mauve.syntax.build import Action
from mauve.syntax.build_behaviours import BEHAVIOUR_ACTIONS
from mauve.syntax.build_binaries import BINARY_ACTIONS
from mauve.syntax.build_components import COMPONENT_ACTIONS
from mauve.syntax.build_flows import FLOW_ACTIONS
from mauve.syntax.build_missions import MISSION_ACTIONS
from mauve.syntax.build_systems import SYSTEM_ACTIONS

ACTIONS: dict[str, Action] = {
    **COMPONENT_ACTIONS,
    **BEHAVIOUR_ACTIONS,
    **SYSTEM_ACTIONS,
    **FLOW_ACTIONS,
    **BINARY_ACTIONS,
    **MISSION_ACTIONS,
}
