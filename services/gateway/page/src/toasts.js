// Short messages over the map: replies to commands, and what happens to the services.

const MOST = 4;
const SHOWN = 7000; // [ms]

/** @param tone "good", "warn", "bad" or "" */
export function toast(text, tone = "", title = "") {
  const stack = document.getElementById("toasts");
  const made = document.createElement("div");
  made.className = `toast ${tone}`;
  if (title) {
    const head = document.createElement("b");
    head.textContent = title;
    made.append(head);
  }
  const line = document.createElement("span");
  line.textContent = text;
  made.append(line);
  made.onclick = () => made.remove();
  stack.append(made);
  while (stack.children.length > MOST) stack.firstChild.remove();
  setTimeout(() => made.remove(), tone === "good" ? SHOWN : 2 * SHOWN);
}
