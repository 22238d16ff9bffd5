// The dialog that lists the keys.
const $ = (id) => document.getElementById(id);

/** Fills it with what is claimed by now. */
export function fillHelp(keys) {
  for (const [group, lines] of keys.help()) {
    const section = document.createElement("section"), title = document.createElement("h3"), dl = document.createElement("dl");
    title.textContent = group;
    for (const [names, text] of lines) {
      const dt = document.createElement("dt"), dd = document.createElement("dd");
      for (const name of names) dt.append(Object.assign(document.createElement("kbd"), { textContent: name }));
      dd.textContent = text;
      dl.append(dt, dd);
    }
    section.append(title, dl);
    $("keys").append(section);
  }
}
export function toggleHelp() {
  if ($("help").open) $("help").close();
  else $("help").showModal();
}
