/* Dialogs: a heading, something to read or fill in, and buttons. */

import { html } from "./elements.js";

/** A dialog with buttons [text, run]; the last one is the one that Enter presses. */
export function ask(heading, content, actions) {
  const dialog = html(
    "dialog",
    { "aria-label": heading, onclose: () => dialog.remove() },
    html(
      "form",
      {
        method: "dialog",
        onsubmit: (event) => {
          event.preventDefault();
          dialog.close();
          actions.at(-1)?.[1]();
        },
      },
      html("h2", {}, heading),
      content,
      html(
        "div",
        { class: "buttons" },
        html("button", { type: "button", onclick: () => dialog.close() }, actions.length ? "Cancel" : "Close"),
        actions.map(([text, run], k) =>
          html(
            "button",
            k === actions.length - 1
              ? { type: "submit", class: "primary" }
              : {
                  type: "button",
                  onclick: () => {
                    dialog.close();
                    run();
                  },
                },
            text,
          ),
        ),
      ),
    ),
  );
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}
