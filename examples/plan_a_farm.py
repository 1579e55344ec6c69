"""Plan a round over the example farm and write what a crew needs: `python examples/plan_a_farm.py [OUTPUT]`."""

import sys
from pathlib import Path

import pondhop

output = Path(sys.argv[1] if len(sys.argv) > 1 else "out/example")
output.mkdir(parents=True, exist_ok=True)

farm = pondhop.read_farm(Path(__file__).with_name("delta_farm.geojson"))
farm_plan = pondhop.plan(farm, pondhop.Fleet(num_drones=5))

for trip in farm_plan.trips:
    first = farm.ponds[trip.ponds[0]].id
    print(f"drone {trip.drone + 1}: {len(trip.ponds)} ponds, {trip.length_m / 1000:.1f} km, first to {first}")

pondhop.write_plan_json(output / "plan.json", farm_plan)
for mission in pondhop.write_missions(output, farm_plan):
    print(f"mission: {mission}")
