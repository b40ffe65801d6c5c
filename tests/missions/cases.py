"""A mission without any message, and its declarations for others."""

from __future__ import annotations

HEAD = """mauve 1
hardware Gps: gps may fail, may recover
hardware Imu: imu may fail, may recover
hardware Arm: arm may fail
hardware Clock
resource position: Position
resource attitude: Attitude
resource place: Pose shared
activity gps_driver { consumes Gps produces position }
activity imu_driver { consumes Imu produces attitude }
activity localisation {
  produces place
  alternative gps priority 2 { consumes position }
  alternative imu priority 1 { consumes attitude }
}
activity move { consumes place }
activity look { consumes place }
activity grip { consumes Arm }
activity film { consumes Clock }
objective Move { does move }
objective Look { does look }
objective Grip { does grip }
objective Film { does film }
"""

GOOD = HEAD + "mission M {\n  Move ; Look ; Grip ; Film\n  accepts single failure of Arm\n}\n"
