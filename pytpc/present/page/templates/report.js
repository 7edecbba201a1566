// The page: what is drawn when, theme, sorting, search, and what is unfolded.
(() => {
  "use strict";
  const root = document.documentElement;
  root.classList.add("script");

  // A figure is drawn when it is about to be seen, and takes the place of the one that stands still.
  const draw = (host) => {
    const target = document.createElement("div");
    target.className = "moving-figure";
    host.querySelector(".still").before(target);
    const make = "timeline" in host.dataset ? tpcTimeline.timeline : tpcFigures.evidence;
    const column = new Bokeh.Column({ children: make(host), sizing_mode: "stretch_width", spacing: 0 });
    host.classList.add("drawn");
    return Bokeh.Plotting.show(column, target);
  };
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      seen.unobserve(entry.target);
      draw(entry.target);
    }
  }, { rootMargin: "300px" });
  for (const host of document.querySelectorAll(".figure[data-mission]")) seen.observe(host);

  tpcTheme(() => tpcFigures.repaint());

  // Sorting: a press on a column's head; another press turns it around.
  const sort = (table, id, head) => {
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of table.querySelectorAll("th[aria-sort]")) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const body = table.tBodies[0];
    const of = (row) => row.getAttribute(`data-${id}`);
    const text = id === "parameter" || id === "place";
    const rows = [...body.rows].sort((a, b) =>
      text ? (of(a) < of(b) ? -1 : of(a) > of(b) ? 1 : 0) : Number(of(a)) - Number(of(b)));
    if (down) rows.reverse();
    body.append(...rows);
    trim(table);
  };
  // Of a long table the first rows are shown, in whatever order it is.
  const trim = (table) => {
    if (table.classList.contains("whole")) return;
    [...table.tBodies[0].rows].forEach((row, place) => row.classList.toggle("rest", place >= ROWS));
  };
  const ROWS = Number(document.body.dataset.rows);
  for (const table of document.querySelectorAll("table.ranking")) {
    for (const head of table.querySelectorAll("th[data-sort]")) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = head.textContent;
      head.replaceChildren(button);
      button.addEventListener("click", () => sort(table, head.dataset.sort, head));
    }
    table.querySelector("th[data-sort=position]").setAttribute("aria-sort", "ascending");
    const more = table.closest("details").querySelector("button.more");
    if (more === null) continue;
    more.hidden = false;
    more.addEventListener("click", () => {
      table.classList.add("whole");
      for (const row of table.tBodies[0].rows) row.classList.remove("rest");
      more.hidden = true;
    });
  }

  // Search: rows and cards of a mission that have all the words; marks without any are folded away.
  for (const section of document.querySelectorAll("section.mission")) {
    const label = section.querySelector(".search");
    if (label === null) continue;
    label.hidden = false;
    const found = section.querySelector(".found");
    const items = [...section.querySelectorAll("table.ranking tbody tr, details.card")];
    const texts = items.map((item) => item.textContent.toLowerCase());
    label.querySelector("input").addEventListener("input", (event) => {
      const words = event.target.value.toLowerCase().split(/\s+/).filter(Boolean);
      let rows = 0;
      items.forEach((item, place) => {
        const fits = words.every((word) => texts[place].includes(word));
        item.classList.toggle("unfit", !fits);
        rows += fits && item.localName === "tr";
      });
      section.classList.toggle("searching", words.length > 0);
      for (const mark of section.querySelectorAll("details.mark")) {
        const has = mark.querySelector("tbody tr:not(.unfit)") !== null;
        mark.classList.toggle("unfit", words.length > 0 && !has);
      }
      found.textContent = words.length ? `${rows} row${rows === 1 ? "" : "s"} found` : "";
    });
  }

  // Several missions are tabs: one is shown, the arrows go to the next one, and a link to anything
  // in a mission shows that one.
  const tabs = [...document.querySelectorAll(".tabs a")];
  const choose = (tab) => {
    for (const other of tabs) {
      const own = other === tab;
      other.setAttribute("aria-selected", String(own));
      other.tabIndex = own ? 0 : -1;
      document.getElementById(other.dataset.panel).classList.toggle("away", !own);
    }
  };
  const go = (tab) => {
    choose(tab);
    history.replaceState(null, "", tab.hash);
  };
  if (tabs.length) {
    tabs[0].parentElement.setAttribute("role", "tablist");
    tabs.forEach((tab, place) => {
      tab.setAttribute("role", "tab");
      tab.setAttribute("aria-controls", tab.dataset.panel);
      const panel = document.getElementById(tab.dataset.panel);
      panel.setAttribute("role", "tabpanel");
      tab.addEventListener("click", (event) => {
        event.preventDefault();
        go(tab);
      });
      tab.addEventListener("keydown", (event) => {
        const last = tabs.length - 1;
        const to = {
          ArrowLeft: place ? place - 1 : last, ArrowRight: place < last ? place + 1 : 0,
          Home: 0, End: last, " ": place,
        }[event.key];
        if (to === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        go(tabs[to]);
        tabs[to].focus();
      });
    });
    choose(tabs[0]);
  }

  // A term is explained under the pointer, at the focus, and where it is tapped.
  const tip = document.createElement("div");
  tip.className = "tip";
  tip.setAttribute("role", "tooltip");
  tip.hidden = true;
  document.body.append(tip);
  const hide = () => { tip.hidden = true; };
  const explain = (term) => {
    tip.textContent = document.getElementById(term.hash.slice(1)).textContent;
    tip.hidden = false;
    const at = term.getBoundingClientRect();
    const below = at.bottom + 6 + tip.offsetHeight <= innerHeight;
    tip.style.left = `${Math.max(8, Math.min(at.left, root.clientWidth - tip.offsetWidth - 8))}px`;
    tip.style.top = `${below ? at.bottom + 6 : Math.max(0, at.top - 6 - tip.offsetHeight)}px`;
  };
  for (const term of document.querySelectorAll(".term")) {
    for (const kind of ["pointerenter", "focus"]) term.addEventListener(kind, () => explain(term));
    for (const kind of ["pointerleave", "blur"]) term.addEventListener(kind, hide);
    term.addEventListener("click", (event) => {
      event.preventDefault();
      explain(term);
    });
  }
  addEventListener("keydown", (event) => { if (event.key === "Escape") hide(); });
  addEventListener("scroll", hide, { passive: true });
  addEventListener("pointerdown", (event) => { if (!event.target.closest(".term")) hide(); });

  for (const button of document.querySelectorAll("button.copy")) {
    // A page from a file is no secure context everywhere: there the text is only selected.
    button.hidden = false;
    button.addEventListener("click", async () => {
      getSelection().selectAllChildren(button.previousElementSibling);
      try {
        await navigator.clipboard.writeText(button.previousElementSibling.textContent);
        button.textContent = "Copied";
      } catch {
        button.textContent = "Selected";
      }
    });
  }

  // A link leads to what is folded away, and nobody prints what is.
  const reveal = () => {
    const target = location.hash.length > 1 && document.getElementById(location.hash.slice(1));
    if (!target) return;
    const panel = target.closest("section.mission");
    if (panel && tabs.length) choose(tabs.find((tab) => tab.dataset.panel === panel.id));
    for (let at = target; at; at = at.parentElement) if (at.localName === "details") at.open = true;
    target.scrollIntoView();
  };
  // The same link twice changes no address.
  addEventListener("click", (event) => {
    const link = event.target.closest("a[href^='#']");
    if (link && link.hash === location.hash && !event.defaultPrevented) reveal();
  });
  addEventListener("hashchange", reveal);
  const opened = [];
  addEventListener("beforeprint", () => {
    for (const folded of document.querySelectorAll("details:not([open])")) {
      folded.open = true;
      opened.push(folded);
    }
  });
  addEventListener("afterprint", () => {
    for (const folded of opened.splice(0)) folded.open = false;
  });
  reveal();
  root.classList.add("ready");
})();
