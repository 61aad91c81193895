import { byId } from "./dom.ts";
import { Drive } from "./drive.ts";
import { read } from "./format.ts";
import { Page } from "./page.ts";

const words = (id: string) => byId(id, HTMLScriptElement).textContent;

async function main(): Promise<void> {
  if (typeof DecompressionStream === "undefined") throw new Error("this browser is older than 2023");
  const [said, columns] = await read(words("atm-said"), words("atm-data"));
  const page = new Page(new Drive(said, columns));
  page.start();
  document.documentElement.dataset["ready"] = "yes";
}

main().catch((error: unknown) => {
  const notice = byId("notice", HTMLParagraphElement);
  notice.hidden = false;
  notice.textContent = `This replay can't be shown: ${error instanceof Error ? error.message : String(error)}`;
  document.documentElement.dataset["ready"] = "failed";
});
