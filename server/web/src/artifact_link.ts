// A link to a job's file. Links send no token: with one, the file is fetched by the page and then saved.

import { getBlob, hasToken, type Artifact } from "./api";
import { element } from "./elements";

const KEPT_MS = 60_000; // time for the browser to start saving

async function save(artifact: Artifact): Promise<void> {
  const url = URL.createObjectURL(await getBlob(artifact.href));
  element("a", { href: url, download: nameOf(artifact) }).click();
  setTimeout(() => URL.revokeObjectURL(url), KEPT_MS);
}

const nameOf = ({ path }: Artifact) => path.split("/").pop()!;

/// `save`: to the disk; otherwise the browser shows it, if it can.
export function artifactLink(artifact: Artifact, text: string, options: { save?: boolean; class?: string } = {}): HTMLAnchorElement {
  const link = element("a", { href: artifact.href, class: options.class, download: options.save === true && nameOf(artifact) });
  link.append(text);
  if (hasToken())
    link.addEventListener("click", (event) => {
      event.preventDefault();
      void save(artifact);
    });
  return link;
}
