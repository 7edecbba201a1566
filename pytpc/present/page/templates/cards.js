// A link to a card opens it, and nobody prints what is folded away.
const tpcCards = (cards) => {
  "use strict";
  const reveal = () => {
    const card = location.hash && document.getElementById(location.hash.slice(1));
    if (card && card.tagName === "DETAILS") card.open = true;
  };
  window.addEventListener("hashchange", reveal);
  window.addEventListener("beforeprint", () => { for (const card of cards) card.open = true; });
  reveal();
};
