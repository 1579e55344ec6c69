"""Plan a round over the example farm and write what a crew needs: `python examples/plan_a_farm.py [OUTPUT]`."""

import sys
from pathlib import Path

import pondhop

output = Path(sys.argv[1] if len(sys.argv) > 1 else "out/example")
output.mkdir(parents=True, exist_ok=True)

farm = pondhop.read_farm(Path(__file__).with_name("delta_farm.geojson"))
farm_plan = pondhop.plan(farm, pondhop.Fleet(num_drones=5))

plan = farm_plan.solution.plan
for drone, (route, length_m) in enumerate(zip(plan.routes, plan.route_lengths, strict=True), start=1):
    print(f"drone {drone}: {len(route)} ponds, {length_m / 1000:.1f} km, first to {farm.ponds[route[0]].id}")

pondhop.write_plan_json(output / "plan.json", farm_plan)
for mission in pondhop.write_missions(output, farm_plan):
    print(f"mission: {mission}")
