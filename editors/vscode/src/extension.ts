import * as path from "node:path";
import { commands, ExtensionContext, window, workspace } from "vscode";
import {
  LanguageClient,
  LanguageClientOptions,
  ServerOptions,
  TransportKind,
} from "vscode-languageclient/node";

const INSTALL = 'pip install ".[lsp]" in a clone of fuzzyarm';

let client: LanguageClient | undefined;

/** The command of the settings; a relative path in it starts at the folder of the workspace. */
function serverCommand(): { command: string; args: string[] } {
  const words = workspace.getConfiguration("fuzzyarm").get<string[]>("command") ?? [];
  const [first = "fuzzyarm", ...args] = words.length > 0 ? words : ["fuzzyarm", "lsp"];
  const folder = workspace.workspaceFolders?.[0]?.uri.fsPath;
  const isRelative = !path.isAbsolute(first) && /[\\/]/.test(first);
  const command = isRelative && folder !== undefined ? path.join(folder, first) : first;
  return { command, args };
}

async function start(): Promise<void> {
  const { command, args } = serverCommand();
  const server: ServerOptions = { command, args, transport: TransportKind.stdio };
  const options: LanguageClientOptions = {
    documentSelector: [{ language: "fuzzyarm" }, { language: "fuzzyarm-table" }],
  };
  client = new LanguageClient("fuzzyarm", "fuzzyarm", server, options);
  try {
    await client.start();
  } catch {
    client = undefined;
    const shown = [command, ...args].join(" ");
    void window.showErrorMessage(
      `fuzzyarm: the language server does not start (${shown}). Install it with ${INSTALL}, ` +
        "or set fuzzyarm.command.",
    );
  }
}

async function stop(): Promise<void> {
  const running = client;
  client = undefined;
  await running?.stop();
}

export async function activate(context: ExtensionContext): Promise<void> {
  context.subscriptions.push(
    commands.registerCommand("fuzzyarm.restart", async () => {
      await stop();
      await start();
    }),
    workspace.onDidChangeConfiguration(async (change) => {
      if (change.affectsConfiguration("fuzzyarm.command")) {
        await stop();
        await start();
      }
    }),
  );
  await start();
}

export async function deactivate(): Promise<void> {
  await stop();
}
