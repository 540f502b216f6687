#include "report/page.h"

namespace sightcell::cli {

// Colors: text has a contrast of 4.5:1 or more on its background, in both schemes. The ramp q0 to q6 is viridis, which
// color-blind people can read.
const char* const page_style = R"(
:root { color-scheme: light dark; --page: #ffffff; --ink: #1b222c; --soft: #566270; --line: #d9dfe6; --tint: #f4f6f9;
  --accent: #24669c; --good: #1b6e47; --bad: #ad2c2c; --bar: #3b7db5; }
@media (prefers-color-scheme: dark) { :root { --page: #14181e; --ink: #e6eaf0; --soft: #a5b0bd; --line: #323a45;
  --tint: #1d232b; --accent: #7fb8e8; --good: #6ccf9f; --bad: #f08a84; --bar: #5a9bd0; } }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.55 system-ui, -apple-system, "Segoe UI",
  Roboto, "Helvetica Neue", Arial, sans-serif; overflow-wrap: anywhere; }
main { max-width: 1080px; margin: 0 auto; padding: 28px 20px 60px; }
h1 { font-size: 28px; line-height: 1.2; margin: 0 0 4px; letter-spacing: -0.01em; }
h2 { font-size: 20px; line-height: 1.3; margin: 48px 0 12px; padding-top: 14px; border-top: 1px solid var(--line); }
h3 { font-size: 16px; line-height: 1.4; margin: 22px 0 6px; }
p { margin: 0 0 12px; max-width: 72ch; }
.file { color: var(--soft); margin: 0 0 20px; }
.note, figcaption, .legend { color: var(--soft); font-size: 14px; line-height: 1.45; }
.verdict { font-size: 18px; line-height: 1.5; }
.good { color: var(--good); font-weight: 600; }
.bad { color: var(--bad); font-weight: 600; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 1px; margin: 20px 0 0;
  border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
.figures div { box-shadow: 0 0 0 1px var(--line); padding: 12px 14px; }
.figures b { display: block; font-size: 22px; line-height: 1.25; font-weight: 600; font-variant-numeric: tabular-nums; }
.figures span { color: var(--soft); font-size: 14px; line-height: 1.35; display: block; }
.figures b span { color: inherit; font-size: inherit; display: inline; }
code, pre { font: 13.5px/1.5 ui-monospace, SFMono-Regular, Menlo, Consolas, "DejaVu Sans Mono", monospace; }
pre { background: var(--tint); border: 1px solid var(--line); border-radius: 6px; padding: 8px 12px; margin: 6px 0 12px;
  white-space: pre-wrap; }
code span { display: inline-block; }
ol.next { padding-left: 1.4em; margin: 0; }
ol.next li { margin-bottom: 16px; }
ol.next b { display: block; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 15px; }
th, td { text-align: left; vertical-align: baseline; padding: 6px 12px 6px 0; border-bottom: 1px solid var(--line); }
thead th { color: var(--soft); font-weight: 500; font-size: 14px; }
td.n, th.n { text-align: right; padding-right: 0; padding-left: 12px; white-space: nowrap; }
td.n + td:not(.n), th.n + th:not(.n) { padding-left: 20px; }
table.facts th { font-weight: 500; color: var(--soft); width: 42%; }
.bars { margin: 8px 0 16px; }
.bar { display: grid; grid-template-columns: minmax(110px, 2fr) 4fr 130px; gap: 12px; align-items: center;
  font-size: 15px; padding: 3px 0; }
.bar .value { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.bar .line { width: 100%; height: 10px; background: var(--tint); border-radius: 2px; display: block; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 300px), 1fr)); gap: 16px 32px; }
.charts figure, .plans figure, .view figure { margin: 0; }
.chart { width: 100%; max-width: 420px; height: auto; display: block; }
.chart text { font-size: 11px; fill: var(--soft); }
.fill { fill: var(--bar); }
.axis { stroke: var(--soft); fill: none; }
.curve { stroke: var(--bar); stroke-width: 2; fill: none; }
.grid { stroke: var(--line); fill: none; stroke-dasharray: 2 3; }
.plans { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 300px), 1fr)); gap: 16px 24px; }
.plan { width: 100%; height: auto; max-height: 560px; display: block; background: #ffffff; border: 1px solid var(--line);
  border-radius: 4px; }
.plan path { stroke: #ffffff; stroke-opacity: 0.9; fill-opacity: 0.72; }
.plan path.scale { stroke: #1b222c; fill: none; }
.shared { position: absolute; }
.q0 { fill: #440154; background: #440154; } .q1 { fill: #443983; background: #443983; }
.q2 { fill: #31688e; background: #31688e; } .q3 { fill: #21918c; background: #21918c; }
.q4 { fill: #35b779; background: #35b779; } .q5 { fill: #90d743; background: #90d743; }
.q6 { fill: #fde725; background: #fde725; } .qnone { fill: #8a94a0; background: #8a94a0; }
.legend { display: flex; flex-wrap: wrap; gap: 2px 8px; align-items: center; margin: 6px 0 0; }
.legend span { white-space: nowrap; }
.legend .of { width: 11em; }
.ramp { display: flex; }
.ramp i { width: 18px; height: 12px; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
.view { margin: 0 0 28px; }
.triple { display: grid; grid-template-columns: repeat(3, 1fr); gap: 8px; margin: 6px 0; }
.triple img { width: 100%; height: auto; display: block; border-radius: 4px; background: var(--tint); }
.plan, .chart, .line { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
@media (max-width: 640px) {
  main { padding: 20px 16px 40px; }
  h1 { font-size: 24px; }
  .bar { grid-template-columns: 1fr auto; gap: 2px 12px; }
  .bar .line { grid-column: 1 / -1; grid-row: 2; }
  .triple { grid-template-columns: 1fr; }
  .legend .of { width: 100%; }
  th, td { padding-right: 8px; }
}
@media print {
  :root { color-scheme: light; --page: #ffffff; --ink: #000000; --soft: #444c55; --line: #c4cbd3; --tint: #f4f6f9;
    --accent: #24669c; --good: #1b6e47; --bad: #ad2c2c; --bar: #3b7db5; }
  body { font-size: 11pt; }
  main { max-width: none; padding: 0; }
  h2, h3 { break-after: avoid; }
  .view, .bar, tr, .figures, figure, ol.next li { break-inside: avoid; }
  .plan { max-height: 17cm; }
}
)";

}  // namespace sightcell::cli
