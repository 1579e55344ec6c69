"""Reproduce the HPP row of the paper's Table 1: `python examples/paper_table_1.py --farms 100`.

Prints a Markdown table: average total length and average longest route of farms drawn as the paper's authors drew them,
planned for 5 drones, and the seconds that planning all of them took on one thread, beside the paper's values.
"""

import argparse
from statistics import fmean

import pondhop

PAPER = {
    50: (7.62, 2.01, 1.38e-3),
    100: (9.94, 2.53, 2.99e-3),
    200: (12.66, 3.14, 4.76e-3),
    300: (15.37, 3.79, 9.51e-3),
    500: (19.02, 4.58, 1.07e-2),
    700: (21.72, 5.28, 1.55e-2),
}
"""Davis et al., Table 1: ponds -> average total distance, average maximum route length, run time in seconds."""

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--farms", type=int, default=100, help="farms per size; the paper has 100")
parser.add_argument("--seed", type=int, default=1)
options = parser.parse_args()

print(f"| ponds | total | paper | longest | paper | seconds for {options.farms} farms | paper, for 100 |")
print("|---|---|---|---|---|---|---|")
for num_ponds, (paper_total, paper_max, paper_s) in PAPER.items():
    farms = pondhop.generate(num_ponds, options.farms, seed=options.seed)
    solutions = [pondhop.solve(farm.to_problem(5), planner="hpp") for farm in farms]
    total = fmean(solution.plan.total_length for solution in solutions)
    longest = fmean(solution.plan.max_route_length for solution in solutions)
    elapsed_s = sum(solution.elapsed_s for solution in solutions)
    lengths = f"{total:.2f} | {paper_total} | {longest:.2f} | {paper_max}"
    print(f"| {num_ponds} | {lengths} | {elapsed_s:.5f} | {paper_s:.5f} |")
