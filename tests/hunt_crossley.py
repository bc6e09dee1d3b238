"""The law of examples/third_party_law, whose force depends on the rate, as a plug-in module."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples" / "third_party_law"))
from raceway_hunt_crossley import raceway_contact_laws as raceway_contact_laws  # noqa: E402
