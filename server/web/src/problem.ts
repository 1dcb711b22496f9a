// A failure in words: what happened, what the server says about it, which fields are meant.

import { ProblemError, hasToken, setToken, type Problem } from "./api";
import { button, element } from "./elements";

export function problemBox(problem: Problem): HTMLElement {
  const fields = (problem.errors ?? []).map(({ pointer, detail }) =>
    element("li", {}, pointer !== "" && element("code", {}, pointer), pointer !== "" ? `: ${detail}` : detail),
  );
  return element(
    "div",
    { class: "problem", role: "alert" },
    element("strong", {}, problem.title),
    problem.detail !== undefined && !repeats(problem) && element("p", {}, problem.detail),
    fields.length > 0 && element("ul", {}, ...fields),
    problem.word !== undefined && element("p", { class: "soft" }, "error word ", element("code", {}, problem.word)),
    problem.status === 401 && tokenForm(),
  );
}

/// The detail may say no more than the title, or than the only field that is wrong.
const repeats = ({ title, detail, errors = [] }: Problem) =>
  detail === title || errors.some((error) => detail === `${error.pointer}: ${error.detail}`);

/// Any error, unless it only says that the view has gone.
export function failureBox(error: unknown): HTMLElement {
  if (error instanceof ProblemError) return problemBox(error.problem);
  return problemBox({
    title: "Something went wrong in this page",
    status: 0,
    detail: error instanceof Error ? error.message : String(error),
  });
}

function tokenForm(): HTMLElement {
  const input = element("input", { type: "password", id: "token", autocomplete: "off" });
  const form = element(
    "form",
    {},
    element("label", { for: "token" }, hasToken() ? "This token is not accepted; another one" : "Access token"),
    input,
    button("Use it", () => form.requestSubmit()),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    setToken(input.value.trim());
    dispatchEvent(new HashChangeEvent("hashchange"));
  });
  return form;
}
