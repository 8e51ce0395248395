/** Accessibility rules, run inside the page. */

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const source = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** One line a violation: the rule, the elements, what to do. */
export async function violations(page) {
  // The page's Content-Security-Policy forbids script elements; the debugger may still evaluate.
  await page.evaluate(`${source};undefined`);
  return page.evaluate(async () => {
    const results = await window.axe.run(document);
    return results.violations.map(
      ({ id, help, nodes }) => `${id} (${help}): ${nodes.map((node) => node.target).join(', ')}`,
    );
  });
}
