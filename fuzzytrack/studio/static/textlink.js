/* A link to a line of the text of the rule base, for what is edited only there. */

import { html } from "./elements.js";

/** The link; its place is its name, and in its words unless `short`. */
export function textLink(app, words, line, short = false) {
  return html(
    "button",
    {
      type: "button",
      class: "link",
      title: `${words}: edit it in the text${line ? `, line ${line}` : ""}`,
      onclick: () => app.show({ tab: "text", line: line ? { line, column: 1 } : null }),
    },
    line && !short ? `${words}, line ${line}` : words,
  );
}
