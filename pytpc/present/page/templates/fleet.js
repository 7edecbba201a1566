tpcTheme(() => {});
tpcCards([...document.querySelectorAll("details.card")]);
