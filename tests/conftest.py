"""What all tests share."""

from hypothesis import HealthCheck, settings

# A slow machine is no defect: no test depends on time.
settings.register_profile(
    "untimed", settings(), deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("untimed")
