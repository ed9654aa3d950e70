// The pictures of another scene than the chosen one are grey until its own come; its kernels may have to be compiled.
export function markAnotherScene(model) {
  const mark = () => {
    const { shown } = window.granchain;
    document.getElementById("page").classList.toggle("another", Boolean(shown) && shown.scene !== model.state.scene);
  };
  model.on("state", mark);
  window.granchain.on("shown", mark);
}
