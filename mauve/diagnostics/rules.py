"""The one table of rules: code, slug, default severity. Each code has a page in pages/CODE.md and a test.

The first digit names the phase: 0 syntax, 1 names and imports, 2 types, ports and connections, 3 behaviour,
4 deployment, 5 binaries and WCET, 6 schedulability, 7 missions, 9 internal.
"""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Severity
from mauve.records import record

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE


@record
class Rule:
    """A kind of diagnostic. `slug` is its readable name, `severity` the usual one."""

    code: str
    slug: str
    severity: Severity


RULES: dict[str, Rule] = {
    rule.code: rule
    for rule in (
        # 0 syntax
        Rule("MV001", "syntax", ERROR),
        Rule("MV002", "unreadable-file", ERROR),
        Rule("MV003", "language-version", ERROR),
        Rule("MV004", "unknown-unit", ERROR),
        Rule("MV005", "reserved-word", ERROR),
        Rule("MV006", "one-per-line", ERROR),
        Rule("MV007", "number-out-of-range", ERROR),
        Rule("MV008", "file-too-large", ERROR),
        # 1 names and imports
        Rule("MV100", "unknown-name", ERROR),
        Rule("MV101", "unknown-component", ERROR),
        Rule("MV102", "unknown-type", ERROR),
        Rule("MV103", "duplicate-name", ERROR),
        Rule("MV104", "unknown-import", ERROR),
        Rule("MV105", "import-cycle", ERROR),
        Rule("MV106", "unknown-instance", ERROR),
        Rule("MV107", "unknown-codel", ERROR),
        Rule("MV108", "unknown-data", ERROR),
        Rule("MV109", "unknown-board", ERROR),
        Rule("MV110", "unknown-architecture", ERROR),
        Rule("MV111", "unknown-lifecycle", ERROR),
        Rule("MV112", "unknown-port", ERROR),
        Rule("MV113", "unknown-property", ERROR),
        # 2 types, ports and connections
        Rule("MV201", "type-mismatch", ERROR),
        Rule("MV202", "codel-access", ERROR),
        Rule("MV203", "recursive-type", ERROR),
        Rule("MV204", "port-direction", ERROR),
        Rule("MV205", "fan-in-unbuffered", ERROR),
        Rule("MV206", "queue-overflow", ERROR),
        Rule("MV207", "signature-mismatch", ERROR),
        Rule("MV208", "bad-value", ERROR),
        Rule("MV209", "buffer-size", ERROR),
        Rule("MV210", "unconnected-method", ERROR),
        Rule("MV211", "unconnected-port", WARNING),
        Rule("MV212", "duplicate-connection", ERROR),
        Rule("MV213", "unbounded-queue", ERROR),
        Rule("MV214", "data-race", ERROR),
        Rule("MV216", "flow-path", ERROR),
        Rule("MV217", "global-race", WARNING),
        # 3 behaviour
        Rule("MV301", "unreachable-state", ERROR),
        Rule("MV302", "initial-state", ERROR),
        Rule("MV303", "unknown-state", ERROR),
        Rule("MV304", "guard-not-bool", ERROR),
        Rule("MV305", "no-way-back", WARNING),
        Rule("MV306", "shadowed-transition", WARNING),
        Rule("MV307", "bad-step", ERROR),
        Rule("MV308", "passive-behaviour", ERROR),
        Rule("MV312", "call-cycle", ERROR),
        Rule("MV313", "call-own-thread", ERROR),
        Rule("MV314", "call-in-critical-section", ERROR),
        Rule("MV315", "requests-not-served", ERROR),
        # 4 deployment
        Rule("MV401", "activation", ERROR),
        Rule("MV402", "region-placed-twice", ERROR),
        Rule("MV403", "region-not-placed", ERROR),
        Rule("MV404", "deployment-cycle", ERROR),
        Rule("MV405", "board", ERROR),
        Rule("MV406", "nothing-to-check", WARNING),
        Rule("MV407", "unsupported-deployment", ERROR),
        Rule("MV411", "gcd-period", WARNING),
        Rule("MV420", "default-value", NOTE),
        # 5 binaries and WCET
        Rule("MV501", "symbol-not-found", ERROR),
        Rule("MV502", "unreadable-binary", ERROR),
        Rule("MV503", "not-an-arm-binary", ERROR),
        Rule("MV504", "stale-binary", WARNING),
        Rule("MV505", "not-a-function", ERROR),
        Rule("MV506", "undecodable-instruction", ERROR),
        Rule("MV507", "unresolved-branch", ERROR),
        Rule("MV508", "recursion", ERROR),
        Rule("MV509", "code-outside-memory", ERROR),
        Rule("MV510", "unmodelled-hardware", ERROR),
        Rule("MV511", "unbounded-loop", ERROR),
        Rule("MV512", "irreducible-loop", ERROR),
        Rule("MV513", "unknown-core", ERROR),
        Rule("MV514", "fact-matches-nothing", ERROR),
        Rule("MV515", "fact-contradicted", ERROR),
        Rule("MV516", "fact-syntax", ERROR),
        Rule("MV517", "analysis-limit", ERROR),
        Rule("MV518", "fact-matches-several", NOTE),
        Rule("MV519", "ideal-memory", NOTE),
        Rule("MV520", "no-wcet", ERROR),
        Rule("MV521", "time-given-twice", WARNING),
        # 6 schedulability
        Rule("MV601", "deadline-missed", ERROR),
        Rule("MV602", "overload", ERROR),
        Rule("MV603", "method-unsound", WARNING),
        Rule("MV604", "expectation-failed", ERROR),
        Rule("MV605", "response-unbounded", ERROR),
        Rule("MV606", "flow-late", ERROR),
        Rule("MV607", "priorities-proposed", NOTE),
        Rule("MV620", "unreadable-task-set", ERROR),
        Rule("MV621", "task-set-syntax", ERROR),
        Rule("MV622", "task-set-field", ERROR),
        Rule("MV623", "task-set-value", ERROR),
        Rule("MV624", "duplicate-task", ERROR),
        Rule("MV625", "no-priorities-found", WARNING),
        Rule("MV626", "method-fell-back", NOTE),
        Rule("MV627", "not-carried-over", ERROR),
        # 7 missions
        Rule("MV701", "parallel-without-mandatory", ERROR),
        Rule("MV702", "unknown-resource", ERROR),
        Rule("MV703", "resource-produced-twice", ERROR),
        Rule("MV704", "cyclic-production", ERROR),
        Rule("MV705", "same-priority", ERROR),
        Rule("MV706", "shadowed-alternative", WARNING),
        Rule("MV707", "identical-alternative", WARNING),
        Rule("MV708", "resource-kind", ERROR),
        Rule("MV709", "contention", ERROR),
        Rule("MV710", "impossible-objective", ERROR),
        Rule("MV711", "unused-in-mission", WARNING),
        Rule("MV712", "recursive-objective", ERROR),
        Rule("MV713", "success-unreachable", ERROR),
        Rule("MV714", "single-point-of-failure", WARNING),
        Rule("MV715", "dependent-optional", WARNING),
        Rule("MV716", "activity-component-mismatch", ERROR),
        Rule("MV717", "vanishing-resource", ERROR),
        Rule("MV718", "impossible-recovery", WARNING),
        Rule("MV719", "useless-retry", WARNING),
        Rule("MV720", "too-many-states", WARNING),
        Rule("MV721", "check-fails", ERROR),
        Rule("MV722", "untied-activity", NOTE),
        Rule("MV723", "unclear-instance", ERROR),
        Rule("MV724", "mode-unschedulable", ERROR),
        Rule("MV725", "check-undecided", ERROR),
        # 9 internal
        Rule("MV901", "internal", ERROR),
    )
}
