// node drive/look.mjs PAGE.html PICTURE.png [WIDTH HEIGHT [SCRIPT]]: a screenshot of a page in headless Chromium.
// SCRIPT is run in the page first.
import { open } from "./browser.mjs";

const [page, picture, width = "1280", height = "900", script] = process.argv.slice(2);
const { tab, browser } = await open(page, { width: Number(width), height: Number(height) });
if (script) await tab.evaluate(script);
await tab.waitForTimeout(300);
await tab.screenshot({ path: picture });
await browser.close();
