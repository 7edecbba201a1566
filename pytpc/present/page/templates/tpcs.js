(() => {
  const box = document.getElementById("filter");
  const shown = document.getElementById("shown");
  const cards = [...document.querySelectorAll("details.tpc")];
  const groups = [...document.querySelectorAll("section.package, section.file")];
  const kinds = [...document.querySelectorAll("input.kind")];
  const apply = () => {
    const words = box.value.toLowerCase().split(/\s+/).filter(Boolean);
    const wanted = new Set(kinds.filter((kind) => kind.checked).map((kind) => kind.value));
    let count = 0;
    for (const card of cards) {
      const fits = wanted.has(card.dataset.kind) && words.every((word) => card.dataset.words.includes(word));
      card.hidden = !fits;
      count += fits;
    }
    for (const group of groups) {
      group.hidden = !group.querySelector("details.tpc:not([hidden])");
    }
    shown.textContent = `${count} of ${cards.length} shown`;
  };
  document.getElementById("controls").hidden = false;
  box.addEventListener("input", apply);
  for (const kind of kinds) kind.addEventListener("change", apply);
  for (const [name, open] of [["unfold", true], ["fold", false]]) {
    document.getElementById(name).addEventListener("click", () => {
      for (const card of cards) if (!card.hidden) card.open = open;
    });
  }
  tpcCards(cards);
  apply();
})();
