// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The template of pages of results, and their style sheet.
/// A result as one HTML page that needs nothing else: no network, no library, no file beside it.
#pragma once

#include <string>
#include <vector>

#include "equidem/output/page/drawn_figures.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

inline constexpr const char* page_template = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{heading}</title>
<style>
{style}</style>
</head>
<body>
<header>
<p class="verb">equidem {verb} <span class="status {status}">{state}</span></p>
<h1>{heading}</h1>
</header>
<main>
{body}</main>
<footer><p>equidem {version}</p></footer>
</body>
</html>
)";

/// Light or dark as the reader's system asks; figures, drawn on white, are inverted on dark pages with their hues kept.
inline constexpr const char* page_style = R"(:root {
  color-scheme: light dark;
  --paper: #fbfbf9; --card: #ffffff; --ink: #1d2127; --soft: #5b6470; --line: #dfe2e6; --accent: #0b63a5;
  --good: #1a7f4b; --doubtful: #9a6200; --bad: #b3261e; --warn: #fff4e0; --warn-line: #e0a030;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #14171b; --card: #1c2026; --ink: #e6e8eb; --soft: #9aa4b0; --line: #333a43; --accent: #7db8ea;
    --good: #5fc98f; --doubtful: #e8b04a; --bad: #ff8a80; --warn: #33290f; --warn-line: #a8751c;
  }
  figure img, canvas { filter: invert(1) hue-rotate(180deg); mix-blend-mode: screen; }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 1rem/1.55 system-ui, sans-serif; }
header, main, footer { max-width: 68rem; margin: 0 auto; padding: 0 clamp(1rem, 4vw, 2.5rem); }
header { padding-top: 2.2rem; }
h1 { margin: 0.2rem 0 1.4rem; font-size: clamp(1.5rem, 4.5vw, 2.3rem); line-height: 1.2; font-weight: 650; }
h2 { margin: 2.4rem 0 0.7rem; font-size: 0.85rem; font-weight: 650; letter-spacing: 0.08em; text-transform: uppercase;
  color: var(--soft); }
.verb { margin: 0; color: var(--soft); font-family: ui-monospace, monospace; font-size: 0.9rem; }
.status { margin-left: 0.5em; padding: 0.1em 0.7em; border: 1px solid currentColor; border-radius: 1em;
  color: var(--good); font-size: 0.8rem; }
.unstable, .unjudged, .mechanism, .interrupted, .failed { color: var(--bad); }
.warnings { margin-bottom: 1.2rem; padding: 0.2rem 1.1rem; background: var(--warn);
  border-left: 4px solid var(--warn-line); border-radius: 4px; }
.warnings p { margin: 0.7rem 0; }
dl { margin: 0; }
dd { margin: 0; }
.answers { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(15rem, 100%), 1fr)); gap: 0.9rem; }
.answers div { padding: 1rem 1.2rem; background: var(--card); border: 1px solid var(--line); border-radius: 10px;
  display: flex; flex-direction: column; justify-content: space-between; }
.answers dt { color: var(--soft); font-size: 0.9rem; line-height: 1.35; }
.answers dd { margin-top: 0.5rem; font-size: 1.75rem; font-weight: 600; line-height: 1.2;
  font-variant-numeric: tabular-nums; }
.unit { font-size: 0.6em; font-weight: 500; color: var(--soft); }
.error { display: block; margin-top: 0.25rem; font-size: 0.85rem; font-weight: 400; color: var(--soft); }
.quality { margin-top: 1rem; display: grid; grid-template-columns: repeat(auto-fit, minmax(min(22rem, 100%), 1fr));
  column-gap: 2.5rem; }
.quality div { display: flex; justify-content: space-between; gap: 1rem; padding: 0.35rem 0;
  border-bottom: 1px solid var(--line); }
.quality dt { color: var(--soft); }
.quality dd { white-space: nowrap; font-variant-numeric: tabular-nums; }
.quality .unit { font-size: inherit; }
sup { line-height: 0; }
ul { margin: 0; padding: 0; list-style: none; }
.trust li { display: grid; grid-template-columns: 1.6rem 12.5rem 1fr; gap: 0 0.6rem; padding: 0.45rem 0;
  border-bottom: 1px solid var(--line); }
.trust b { font-weight: 600; }
.trust em { grid-column: 3; color: var(--soft); }
@media (max-width: 40rem) {
  .trust li { grid-template-columns: 1.6rem 1fr; }
  .trust .found, .trust em { grid-column: 2; }
}
.sign { width: 1.5rem; height: 1.5rem; border-radius: 50%; color: var(--card); text-align: center; font-weight: 700;
  line-height: 1.5rem; font-size: 0.85rem; }
.good .sign { background: var(--good); }
.doubtful .sign { background: var(--doubtful); }
.bad .sign { background: var(--bad); }
.active { display: flex; flex-wrap: wrap; gap: 0.5rem; }
.active li { padding: 0.15rem 0.8rem; border: 1px solid var(--accent); border-radius: 1em; color: var(--accent);
  font-size: 0.9rem; }
table { margin-top: 1rem; border-collapse: collapse; width: 100%; font-size: 0.92rem; }
caption { text-align: left; color: var(--soft); padding-bottom: 0.3rem; }
th, td { text-align: left; vertical-align: top; padding: 0.3rem 1rem 0.3rem 0; border-top: 1px solid var(--line); }
th { font-weight: 500; width: 34%; }
td { color: var(--soft); }
details { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 0.6rem 1rem; }
summary { cursor: pointer; color: var(--accent); }
pre { margin: 0.7rem 0 0.3rem; overflow-x: auto; font: 0.82rem/1.5 ui-monospace, monospace; }
.table, .command { margin: 0; padding: 0.8rem 1rem; background: var(--card); border: 1px solid var(--line);
  border-radius: 8px; }
section > .table { margin-top: 1rem; }
code { font-family: ui-monospace, monospace; font-size: 0.9em; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); gap: 1.2rem;
  align-items: start; }
figure { margin: 0; }
figure img { display: block; width: 100%; height: auto; background: #fff; border-radius: 8px; }
figcaption { margin-top: 0.4rem; color: var(--soft); font-size: 0.85rem; }
.missing { margin-top: 0.8rem; color: var(--soft); font-size: 0.9rem; }
.player canvas { display: block; max-width: 100%; max-height: 75vh; margin: 0 auto; background: #fff;
  border-radius: 8px; }
.player p { margin: 0.6rem 0 0; color: var(--soft); font-size: 0.9rem; }
.controls { display: flex; gap: 0.8rem; align-items: center; flex-wrap: wrap; }
.controls input { flex: 1 1 12rem; accent-color: var(--accent); }
.controls button { min-width: 5.5em; padding: 0.3em 0.9em; font: inherit; color: var(--accent);
  background: var(--card); border: 1px solid var(--accent); border-radius: 6px; cursor: pointer; }
footer { margin-top: 3rem; padding-bottom: 2rem; color: var(--soft); font-size: 0.85rem; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
@media print { details > pre { display: block; } .controls { display: none; } }
)";

/// The name of the page in a folder of results.
inline constexpr const char* page_name = "index.html";
/// Upper bound of the size of a page.
inline constexpr std::size_t most_page_bytes = 2'000'000;

struct ResultPage {
  std::string verb;       ///< one of those of has_page
  std::string status;     ///< "solved", "unstable", ...
  std::string version;    ///< of the program
  std::string command;    ///< by which the result is computed again
  std::string case_text;  ///< the resolved case, TOML; empty: the verb has none
  std::string report;
  Results results;
  std::vector<DrawnFigure> figures = {};  ///< their files are read
};

/// The page: warnings, the answer with its error and residual, checks of a run, the case, what acts and why the rest
/// does not, figures, the way to repeat it, the report. The same input gives the same bytes. Figures are embedded as
/// they are; those for which no room is left are named.
/// \throws Error (bad_input) where a file of a figure cannot be read
std::string result_page_html(const ResultPage& page);

}  // namespace equidem
